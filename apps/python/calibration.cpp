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

using Unlocked = py::call_guard<py::gil_scoped_release>;

/// A listener whose functions Python may override. Between two pieces of work it sees Ctrl-C.
class PythonListener : public Listener {
 public:
  void warning(const std::string& message) override { PYBIND11_OVERRIDE(void, Listener, warning, message); }
  void warnings(const std::vector<std::string>& messages) override { PYBIND11_OVERRIDE(void, Listener, warnings, messages); }
  void progress(const std::string& label, std::size_t done, std::size_t total) override {
    const py::gil_scoped_acquire lock;
    if (total > 0) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      tell(label, done, total);
      return;
    }
    // The job has failed, for a reason that must not be lost to another one.
    const py::error_scope reason;
    try {
      tell(label, done, total);
    } catch (py::error_already_set& error) {
      error.discard_as_unraisable("poecal.Listener.progress");
    }
  }

 private:
  void tell(const std::string& label, std::size_t done, std::size_t total) {
    PYBIND11_OVERRIDE(void, Listener, progress, label, done, total);
  }
};

/// Where nobody listens, warnings are Python's.
class PlainListener : public PythonListener {
 public:
  void warning(const std::string& message) override {
    const py::gil_scoped_acquire lock;
    if (PyErr_WarnEx(PyExc_UserWarning, message.c_str(), 1) != 0) throw py::error_already_set();
  }
  void warnings(const std::vector<std::string>& messages) override { Listener::warnings(messages); }
};

constexpr ResultFiles kAllFiles{.registration = true, .identification = true, .diagnosis = true};

template <typename Source>
CalibrationRun runTold(CalibrationRun (*run)(const Source&, const std::filesystem::path&, const CalibrateOptions&, const ResultFiles&,
                                             Listener&),
                       const Source& source, const std::filesystem::path& out, const CalibrateOptions& options, const ResultFiles& files,
                       Listener* listener) {
  PlainListener plain;
  return run(source, out, options, files, listener != nullptr ? *listener : plain);
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
  Struct<IdentifyOptions>(module, "IdentifyOptions", "Options of the identification.")
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
      .member("allow_still_joints", &IdentifyOptions::allow_still_joints);
  Struct<DiagnoseOptions>(module, "DiagnoseOptions", "Options of the diagnosis.")
      .made()
      .member("folds", &DiagnoseOptions::folds)
      .member("seed", &DiagnoseOptions::seed);
  Struct<CalibrateOptions>(module, "CalibrateOptions", "Options of a calibration; the result does not depend on `jobs`.")
      .made()
      .member("last", &CalibrateOptions::last)
      .member("identify", &CalibrateOptions::identify)
      .member("diagnose", &CalibrateOptions::diagnose)
      .member("jobs", &CalibrateOptions::jobs);
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
  py::class_<Listener, PythonListener>(module, "Listener", "Hears what a long job has to say; override what is of interest.")
      .def(py::init<>())
      .def("warning", &Listener::warning, py::arg("message"))
      .def("warnings", &Listener::warnings, py::arg("messages"))
      .def("progress", &Listener::progress, py::arg("label"), py::arg("done"), py::arg("total"));
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
  module.def("calibrate", calibrate, py::arg("nominal"), py::arg("measurements"), options(), Unlocked(), "Calibrates a cell from memory.");
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
        PlainListener plain;
        return loadCapture(source, out, jobs, listener != nullptr ? *listener : plain);
      },
      py::arg("source"), py::arg("out"), py::arg("jobs") = 1, py::arg("listener") = py::none(), Unlocked(),
      "Reads a capture; its intrinsics and corners are found where it names none.");
  module.def("openCapture", openCapture, py::arg("source"), "Reads a capture folder with the files of `source` in their places.");
  module.def("writeResults", writeResults, py::arg("calibration"), py::arg("measurements"), py::arg("files"), py::arg("out"), Unlocked(),
             "Writes what the calibration holds of these files into `out`.");
  module.def("writeReport", writeReport, py::arg("run"), py::arg("capture"), py::arg("out"), py::arg("jobs") = 1, Unlocked(),
             "Writes report.json and report.html; says why there is no page, or nothing.");
}

void bindIntrinsics(py::module_& module) {
  Struct<IntrinsicsOptions>(module, "IntrinsicsOptions", "Options of a camera's calibration.")
      .made()
      .member("model", &IntrinsicsOptions::model)
      .member("max_iterations", &IntrinsicsOptions::max_iterations)
      .member("robust", &IntrinsicsOptions::robust)
      .member("bad_view_sigmas", &IntrinsicsOptions::bad_view_sigmas)
      .member("bad_view_factor", &IntrinsicsOptions::bad_view_factor);
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
         Listener* listener) {
        PlainListener plain;
        return calibrateBoardFolder(folder, options, jobs, camera_file, listener != nullptr ? *listener : plain);
      },
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
      .member("jobs", &CheckOptions::jobs);
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
  module.def("checkCapture", checkCapture, py::arg("folder"), py::arg_v("options", CheckOptions(), "CheckOptions()"), Unlocked(),
             "Judges a capture before anything is fitted.");
  module.def("createCapture", createCapture, py::arg("capture"), Unlocked(), "Makes a capture folder to fill in.");
}

}  // namespace

void bindCalibration(py::module_& module) {
  bindOptions(module);
  bindSources(module);
  bindRuns(module);
  bindIntrinsics(module);
  bindChecks(module);
}

}  // namespace poecal::python
