// The main job, from measurements in memory and from folder to folder. Other threads of Python run meanwhile.
#include "binding.hpp"
#include "poecal/calibration/board_folder.hpp"
#include "poecal/calibration/calibrate.hpp"
#include "poecal/calibration/check_capture.hpp"
#include "poecal/calibration/load_capture.hpp"
#include "poecal/calibration/new_capture.hpp"
#include "poecal/calibration/results.hpp"
#include "poecal/calibration/run_capture.hpp"
#include "poecal/report/report.hpp"

namespace poecal::python {
namespace {

constexpr ResultFiles kAllFiles{.registration = true, .identification = true, .diagnosis = true};

template <typename Source>
CalibrationRun runTold(CalibrationRun (*run)(const Source&, const std::filesystem::path&, const CalibrateOptions&, const ResultFiles&,
                                             Listener&),
                       const Source& source, const std::filesystem::path& out, const CalibrateOptions& options, const ResultFiles& files,
                       Listener* listener) {
  return run(source, out, options, files, *GivenListener(listener));
}

void bindOptions(py::module_& module) {
  py::enum_<CalibrationStep>(module, "CalibrationStep", "How far a calibration goes.")
      .value("kRegistration", CalibrationStep::kRegistration)
      .value("kIdentification", CalibrationStep::kIdentification)
      .value("kDiagnosis", CalibrationStep::kDiagnosis);
  py::enum_<CameraChoice>(module, "CameraChoice", "Whether `bundle` may move the camera.")
      .value("kStated", CameraChoice::kStated)
      .value("kFree", CameraChoice::kFree)
      .value("kAuto", CameraChoice::kAuto);
  Struct<RegistrationOptions>(module, "RegistrationOptions", "Options of the registration.")
      .made()
      .member("hypotheses", &RegistrationOptions::hypotheses)
      .member("robust", &RegistrationOptions::robust)
      .member("leave_out_bad", &RegistrationOptions::leave_out_bad)
      .member("progress", &RegistrationOptions::progress);
  Struct<IdentifyOptions>(module, "IdentifyOptions", "Options of the identification; calibrate() has `jobs` and `progress` of its own.")
      .made()
      .member("method", &IdentifyOptions::method)
      .member("tolerance_position", &IdentifyOptions::tolerance_position)
      .member("tolerance_rotation", &IdentifyOptions::tolerance_rotation)
      .member("camera", &IdentifyOptions::camera)
      .member("robust", &IdentifyOptions::robust)
      .member("gao_length_unit", &IdentifyOptions::gao_length_unit)
      .member("hold_out_every", &IdentifyOptions::hold_out_every)
      .member("leave_one_out", &IdentifyOptions::leave_one_out)
      .member("registered", &IdentifyOptions::registered)
      .member("jobs", &IdentifyOptions::jobs)
      .member("allow_still_joints", &IdentifyOptions::allow_still_joints)
      .member("progress", &IdentifyOptions::progress);
  Struct<DiagnoseOptions>(module, "DiagnoseOptions", "Options of the diagnosis; calibrate() has `jobs` and `progress` of its own.")
      .made()
      .member("folds", &DiagnoseOptions::folds)
      .member("seed", &DiagnoseOptions::seed)
      .member("jobs", &DiagnoseOptions::jobs)
      .member("progress", &DiagnoseOptions::progress);
  Struct<CalibrateOptions>(module, "CalibrateOptions",
                           "Options of a calibration. The result does not depend on `jobs`; `progress` is told of every step.")
      .made()
      .member("last", &CalibrateOptions::last)
      .member("identify", &CalibrateOptions::identify)
      .member("diagnose", &CalibrateOptions::diagnose)
      .member("jobs", &CalibrateOptions::jobs)
      .member("progress", &CalibrateOptions::progress);
}

/// What calibrate() does in turn.
void bindSteps(py::module_& module) {
  module.def(
      "registerCell",
      [](const Cell& cell, const std::vector<Observation>& observations, const RegistrationOptions& options) {
        return registerCell(cell, observations, stoppable(options));
      },
      py::arg("cell"), py::arg("observations"), py::arg_v("options", RegistrationOptions(), "RegistrationOptions()"), Unlocked(),
      "Finds where camera and target are, from the corners of pictures.");
  module.def("registerPoses", registerPoses, py::arg("cell"), py::arg("observations"), py::arg("robust") = true, Unlocked(),
             "Finds where an instrument and its tool are, from the poses that it measured.");
  module.def(
      "identify",
      [](const Cell& cell, const Measurements& measurements, const IdentifyOptions& options, const RegistrationResult* registration) {
        return identify(cell, measurements, stoppable(options), registration);
      },
      py::arg("cell"), py::arg("measurements"), py::arg_v("options", IdentifyOptions(), "IdentifyOptions()"),
      py::arg("registration") = py::none(), Unlocked(),
      "Identifies the arm; `registration` is of these measurements, where it was done already.");
  module.def(
      "diagnose",
      [](const Identification& identification, const Measurements& measurements, const DiagnoseOptions& options) {
        return diagnose(identification, measurements, stoppable(options));
      },
      py::arg("identification"), py::arg("measurements"), py::arg_v("options", DiagnoseOptions(), "DiagnoseOptions()"), Unlocked(),
      "Diagnoses what an identification of these measurements leaves.");
}

void bindSources(py::module_& module) {
  using Path = std::filesystem::path;
  Struct<CaptureSource>(module, "CaptureSource", "A capture folder, and files that take the place of what it names. A path is one too.")
      .member("folder", &CaptureSource::folder)
      .member("intrinsics", &CaptureSource::intrinsics)
      .member("detections", &CaptureSource::detections)
      .member("identified", &CaptureSource::identified)
      .def(py::init([](const Path& folder, const Path& intrinsics, const Path& detections, const Path& identified) {
             return CaptureSource{folder, intrinsics, detections, identified};
           }),
           py::arg("folder"), py::arg("intrinsics") = "", py::arg("detections") = "", py::arg("identified") = "");
  py::implicitly_convertible<Path, CaptureSource>();
  Struct<PosesSource>(module, "PosesSource", "An arm's file, and poses of any instrument.")
      .made()
      .member("robot", &PosesSource::robot)
      .member("poses", &PosesSource::poses)
      .member("base_link", &PosesSource::base_link)
      .member("tip_link", &PosesSource::tip_link)
      .member("registration", &PosesSource::registration);
  Struct<ResultFiles>(module, "ResultFiles", "Which files to write.")
      .made()
      .member("registration", &ResultFiles::registration)
      .member("identification", &ResultFiles::identification)
      .member("diagnosis", &ResultFiles::diagnosis);
}

void bindRuns(py::module_& module) {
  Struct<CalibrationRun>(module, "CalibrationRun", "A calibration with what it was made from.")
      .result("measurements", &CalibrationRun::measurements)
      .result("calibration", &CalibrationRun::calibration);
  Struct<LoadedCapture>(module, "LoadedCapture", "A capture with what its pictures gave.")
      .result("capture", &LoadedCapture::capture)
      .result("nominal", &LoadedCapture::nominal)
      .result("measurements", &LoadedCapture::measurements);
  const auto options = [] { return py::arg_v("options", CalibrateOptions(), "CalibrateOptions()"); };
  const auto files = [] { return py::arg_v("files", kAllFiles, "ResultFiles(registration=True, identification=True, diagnosis=True)"); };
  module.def(
      "calibrate",
      [](const Cell& nominal, const Measurements& measurements, const CalibrateOptions& how) {
        return calibrate(nominal, measurements, stoppable(how));
      },
      py::arg("nominal"), py::arg("measurements"), options(), Unlocked(), "Calibrates a cell from memory.");
  module.def(
      "runCapture",
      [](const CaptureSource& source, const std::filesystem::path& out, const CalibrateOptions& how, const ResultFiles& which,
         Listener* listener) { return runTold(runCapture, source, out, how, which, listener); },
      py::arg("source"), py::arg("out"), options(), files(), py::arg("listener") = py::none(), Unlocked(),
      "Calibrates a capture folder and writes the results into `out`.");
  module.def(
      "runPoses",
      [](const PosesSource& source, const std::filesystem::path& out, const CalibrateOptions& how, const ResultFiles& which,
         Listener* listener) { return runTold(runPoses, source, out, how, which, listener); },
      py::arg("source"), py::arg("out"), options(), files(), py::arg("listener") = py::none(), Unlocked(),
      "The same from poses of an instrument.");
  module.def(
      "loadCapture",
      [](const CaptureSource& source, const std::filesystem::path& out, int jobs, Listener* listener) {
        return loadCapture(source, out, jobs, *GivenListener(listener));
      },
      py::arg("source"), py::arg("out"), py::arg("jobs") = 1, py::arg("listener") = py::none(), Unlocked(),
      "Reads a capture; its intrinsics and corners are found where it names none.");
  module.def("openCapture", openCapture, py::arg("source"), "Reads a capture folder with the files of `source` in their places.");
  module.def("writeResults", writeResults, py::arg("calibration"), py::arg("measurements"), py::arg("files"), py::arg("out"), Unlocked(),
             "Writes what the calibration holds of these files into `out`.");
  module.def(
      "writeReport",
      [](const CalibrationRun& run, const std::filesystem::path& capture, const std::filesystem::path& out, int jobs, Listener* listener) {
        return writeReport(run, capture, out, jobs, GivenListener(listener)->progressFunction());
      },
      py::arg("run"), py::arg("capture"), py::arg("out"), py::arg("jobs") = 1, py::arg("listener") = py::none(), Unlocked(),
      "Writes report.json and report.html; says why there is no page, or nothing.");
  module.def(
      "renderReport",
      [](const std::filesystem::path& out, int jobs, Listener* listener) {
        renderReport(out, jobs, GivenListener(listener)->progressFunction());
      },
      py::arg("out"), py::arg("jobs") = 1, py::arg("listener") = py::none(), Unlocked(), "Writes report.html from report.json.");
  module.def("reportJson", reportJson, py::arg("run"), py::arg("pictures"),
             "Text of report.json; `pictures` is their folder as seen from its own; empty: none.");
  module.def("reportBuilt", reportBuilt, "Whether this build can make pages.");
}

void bindIntrinsics(py::module_& module) {
  Struct<IntrinsicsOptions>(module, "IntrinsicsOptions", "Options of a camera's calibration.")
      .made()
      .member("model", &IntrinsicsOptions::model)
      .member("max_iterations", &IntrinsicsOptions::max_iterations)
      .member("robust", &IntrinsicsOptions::robust)
      .member("bad_view_sigmas", &IntrinsicsOptions::bad_view_sigmas)
      .member("bad_view_factor", &IntrinsicsOptions::bad_view_factor)
      .member("progress", &IntrinsicsOptions::progress);
  Struct<ProjectionUncertainty>(module, "ProjectionUncertainty", "What a camera's covariance means in the picture.")
      .result("median_px", &ProjectionUncertainty::median_px)
      .result("largest_px", &ProjectionUncertainty::largest_px);
  Struct<IntrinsicsFit>(module, "IntrinsicsFit", "A camera fitted to some pictures.")
      .result("camera", &IntrinsicsFit::camera)
      .result("held", &IntrinsicsFit::held)
      .result("covariance", &IntrinsicsFit::covariance)
      .result("uncertainty", &IntrinsicsFit::uncertainty)
      .result("rms_px", &IntrinsicsFit::rms_px)
      .result("sigma_px", &IntrinsicsFit::sigma_px)
      .result("pictures", &IntrinsicsFit::pictures)
      .result("points", &IntrinsicsFit::points)
      .result("outliers", &IntrinsicsFit::outliers)
      .result("converged", &IntrinsicsFit::converged);
  Struct<ViewResidual>(module, "ViewResidual", "A picture's residuals under the chosen camera.")
      .result("image", &ViewResidual::image)
      .result("points", &ViewResidual::points)
      .result("used", &ViewResidual::used)
      .result("bad", &ViewResidual::bad)
      .result("left_out", &ViewResidual::left_out)
      .result("rms_px", &ViewResidual::rms_px)
      .result("max_px", &ViewResidual::max_px)
      .result("T_camera_target", &ViewResidual::T_camera_target);
  Struct<IntrinsicsResult>(module, "IntrinsicsResult", "Plain and robust fit; chosen() is the one that was asked for.")
      .result("all", &IntrinsicsResult::all)
      .result("robust", &IntrinsicsResult::robust)
      .result("is_robust", &IntrinsicsResult::is_robust)
      .result("views", &IntrinsicsResult::views)
      .result("warnings", &IntrinsicsResult::warnings)
      .def("chosen", &IntrinsicsResult::chosen, py::return_value_policy::reference_internal);
  module.def(
      "calibrateBoardFolder",
      [](const std::filesystem::path& folder, const IntrinsicsOptions& options, int jobs, const std::filesystem::path& camera_file,
         Listener* listener) { return calibrateBoardFolder(folder, options, jobs, camera_file, *GivenListener(listener)); },
      py::arg("folder"), py::arg("options"), py::arg("jobs"), py::arg("camera_file"), py::arg("listener") = py::none(), Unlocked(),
      "Finds the lens from the pictures of a board in a folder, and writes `camera_file`.");
}

void bindChecks(py::module_& module) {
  py::enum_<CheckLevel>(module, "CheckLevel")
      .value("kOk", CheckLevel::kOk)
      .value("kAdvice", CheckLevel::kAdvice)
      .value("kTooLittle", CheckLevel::kTooLittle)
      .value("kError", CheckLevel::kError);
  Struct<CheckItem>(module, "CheckItem", "One line about a capture.")
      .result("level", &CheckItem::level)
      .result("topic", &CheckItem::topic)
      .result("text", &CheckItem::text);
  Struct<CaptureCheck>(module, "CaptureCheck", "What is there, what is wrong, what would help.")
      .result("items", &CaptureCheck::items)
      .def("exitStatus", &CaptureCheck::exitStatus);
  Struct<CheckOptions>(module, "CheckOptions", "Options of a check.")
      .made()
      .member("detect", &CheckOptions::detect)
      .member("jobs", &CheckOptions::jobs)
      .member("progress", &CheckOptions::progress);
  Struct<NewCapture>(module, "NewCapture", "What is known before the first picture is taken.")
      .made()
      .member("folder", &NewCapture::folder)
      .member("robot", &NewCapture::robot)
      .member("base_link", &NewCapture::base_link)
      .member("tip_link", &NewCapture::tip_link)
      .member("target", &NewCapture::target)
      .member("camera", &NewCapture::camera)
      .member("board", &NewCapture::board)
      .member("setup", &NewCapture::setup);
  module.def(
      "checkCapture",
      [](const std::filesystem::path& folder, const CheckOptions& options) { return checkCapture(folder, stoppable(options)); },
      py::arg("folder"), py::arg_v("options", CheckOptions(), "CheckOptions()"), Unlocked(), "Judges a capture before anything is fitted.");
  module.def("createCapture", createCapture, py::arg("capture"), Unlocked(), "Makes a capture folder to fill in.");
}

}  // namespace

void bindCalibration(py::module_& module) {
  bindOptions(module);
  bindSteps(module);
  bindSources(module);
  bindRuns(module);
  bindIntrinsics(module);
  bindChecks(module);
}

}  // namespace poecal::python
