// What a calibration gives, as plain objects, and the results in a folder.
#include "poecal/calibration/results.hpp"
#include "binding.hpp"
#include "poecal/calibration/calibrate.hpp"
#include "poecal/calibration/fleet.hpp"
#include "poecal/report/fleet_page.hpp"

namespace poecal::python {
namespace {

void bindErrorsOfModels(py::module_& module) {
  Struct<LengthSummary>(module, "LengthSummary", "Mean, median, root mean square, 95 % quantile and maximum of lengths.")
      .result("mean", &LengthSummary::mean)
      .result("median", &LengthSummary::median)
      .result("rms", &LengthSummary::rms)
      .result("p95", &LengthSummary::p95)
      .result("max", &LengthSummary::max);
  Struct<ErrorSummary>(module, "ErrorSummary", "Errors of a set of poses: corners [px], position [m] and rotation [rad] of the flange.")
      .result("poses", &ErrorSummary::poses)
      .result("corners", &ErrorSummary::corners)
      .result("px", &ErrorSummary::px)
      .result("position", &ErrorSummary::position)
      .result("rotation", &ErrorSummary::rotation);
  Struct<FlangeError>(module, "FlangeError", "Distance [m] and angle [rad] of a flange from where it is.")
      .result("position", &FlangeError::position)
      .result("rotation", &FlangeError::rotation);
  Struct<RowErrors>(module, "RowErrors", "Errors of one observation: `lengths` of its corners [px], of poses the distance [m].")
      .result("index", &RowErrors::index)
      .result("lengths", &RowErrors::lengths);
  Struct<ModelStage>(module, "ModelStage", "One model stage: nominal, registered, identified.")
      .result("name", &ModelStage::name)
      .result("calibration", &ModelStage::calibration)
      .result("held_out", &ModelStage::held_out)
      .result("held_out_kept", &ModelStage::held_out_kept)
      .result("held_out_rows", &ModelStage::held_out_rows);
}

void bindAdjustment(py::module_& module) {
  py::enum_<AdjustmentStatus>(module, "AdjustmentStatus")
      .value("kNotRun", AdjustmentStatus::kNotRun)
      .value("kConverged", AdjustmentStatus::kConverged)
      .value("kIterationLimit", AdjustmentStatus::kIterationLimit);
  Struct<AdjustmentStep>(module, "AdjustmentStep", "One step of an adjustment; `rms` is in stated sigmas.")
      .result("cost", &AdjustmentStep::cost)
      .result("rms", &AdjustmentStep::rms)
      .result("scale", &AdjustmentStep::scale);
  Struct<Adjustment>(module, "Adjustment",
                     "A cell fitted to what was measured: `covariance` is of the parameters of `names` [rad; m], `scale` the noise in "
                     "stated sigmas, `weights` of every observation's units 0..1.")
      .result("status", &Adjustment::status)
      .result("cell", &Adjustment::cell)
      .result("beta", &Adjustment::beta)
      .result("names", &Adjustment::names)
      .result("sigma_prior", &Adjustment::sigma_prior)
      .result("covariance", &Adjustment::covariance)
      .result("steps", &Adjustment::steps)
      .result("scale", &Adjustment::scale)
      .result("tolerance", &Adjustment::tolerance)
      .result("chi_square", &Adjustment::chi_square)
      .result("degrees_of_freedom", &Adjustment::degrees_of_freedom)
      .result("rank", &Adjustment::rank)
      .result("condition_number", &Adjustment::condition_number)
      .result("weights", &Adjustment::weights)
      .result("unseen", &Adjustment::unseen)
      .def("reducedChiSquare", &Adjustment::reducedChiSquare);
}

void bindRegistration(py::module_& module) {
  Struct<RegisteredSample>(module, "RegisteredSample", "One sample after registration.")
      .result("sample", &RegisteredSample::sample)
      .result("rms_px", &RegisteredSample::rms_px)
      .result("free_rms_px", &RegisteredSample::free_rms_px)
      .result("left_out", &RegisteredSample::left_out)
      .result("has_pose", &RegisteredSample::has_pose)
      .result("T_camera_target", &RegisteredSample::T_camera_target)
      .result("T_base_flange", &RegisteredSample::T_base_flange)
      .result("covariance", &RegisteredSample::covariance);
  Struct<RegistrationResult>(module, "RegistrationResult", "Where camera and target are, and the flange poses that the camera measured.")
      .result("cell", &RegistrationResult::cell)
      .result("closed_form", &RegistrationResult::closed_form)
      .result("adjustment", &RegistrationResult::adjustment)
      .result("samples", &RegistrationResult::samples)
      .result("rms_px", &RegistrationResult::rms_px)
      .result("rms_all_px", &RegistrationResult::rms_all_px)
      .result("free_rms_px", &RegistrationResult::free_rms_px)
      .result("corner_sigma_px", &RegistrationResult::corner_sigma_px)
      .result("warnings", &RegistrationResult::warnings);
  Struct<PoseRegistration>(module, "PoseRegistration", "Where an instrument and its tool are; warnings of known transforms.")
      .result("adjustment", &PoseRegistration::adjustment)
      .result("warnings", &PoseRegistration::warnings);
}

void bindIdentification(py::module_& module) {
  py::enum_<Method>(module, "Method").value("kGao", Method::kGao).value("kWeighted", Method::kWeighted).value("kBundle", Method::kBundle);
  Struct<SuspectRow>(module, "SuspectRow", "A row that the model contradicts.")
      .result("sample", &SuspectRow::sample)
      .result("residual", &SuspectRow::residual)
      .result("sigmas", &SuspectRow::sigmas)
      .result("left_out", &SuspectRow::left_out);
  Struct<JointDeviation>(module, "JointDeviation", "How an axis stands in the link before it, and where the joint's zero is.")
      .result("tilt", &JointDeviation::tilt)
      .result("shift", &JointDeviation::shift)
      .result("zero", &JointDeviation::zero);
  Struct<Identification>(module, "Identification", "The arm's axes, and how well the data show them.")
      .result("method", &Identification::method)
      .result("model", &Identification::model)
      .result("nominal", &Identification::nominal)
      .result("stages", &Identification::stages)
      .result("suspects", &Identification::suspects)
      .result("poses", &Identification::poses)
      .result("held_out_poses", &Identification::held_out_poses)
      .result("leave_one_out", &Identification::leave_one_out)
      .result("corner_noise", &Identification::corner_noise)
      .result("sigmas_stated", &Identification::sigmas_stated)
      .result("scale", &Identification::scale)
      .result("sigma_position", &Identification::sigma_position)
      .result("sigma_rotation", &Identification::sigma_rotation)
      .result("reduced_chi_square", &Identification::reduced_chi_square)
      .result("degrees_of_freedom", &Identification::degrees_of_freedom)
      .result("arm_beyond_tolerance", &Identification::arm_beyond_tolerance)
      .result("joint_deviations", &Identification::joint_deviations)
      .result("parameter_names", &Identification::parameter_names)
      .result("parameter_deviation", &Identification::parameter_deviation)
      .result("prior_share", &Identification::prior_share)
      .result("rank", &Identification::rank)
      .result("condition_number", &Identification::condition_number)
      .result("unseen", &Identification::unseen)
      .result("gauge", &Identification::gauge)
      .result("camera_refitted", &Identification::camera_refitted)
      .result("warnings", &Identification::warnings);
}

void bindGap(py::module_& module) {
  py::enum_<NoiseSource>(module, "NoiseSource")
      .value("kRepeats", NoiseSource::kRepeats)
      .value("kGiven", NoiseSource::kGiven)
      .value("kEstimated", NoiseSource::kEstimated)
      .value("kUnknown", NoiseSource::kUnknown);
  Struct<GapStage>(module, "GapStage", "One model stage on poses that its fit did not see: `rms` and `excess` in [px], or [m] for poses.")
      .result("stage", &GapStage::stage)
      .result("errors", &GapStage::errors)
      .result("rms", &GapStage::rms)
      .result("excess", &GapStage::excess)
      .result("rms_interval", &GapStage::rms_interval);
  Struct<Shrinkage>(module, "Shrinkage", "How much smaller the excess became, with its 95 % interval.")
      .result("value", &Shrinkage::value)
      .result("interval", &Shrinkage::interval)
      .def("claimed", &Shrinkage::claimed);
  Struct<GapPlace>(module, "GapPlace", "A place and a driver at which what identification left shows structure.")
      .result("location", &GapPlace::location)
      .result("driver", &GapPlace::driver)
      .result("share", &GapPlace::share)
      .result("p_value", &GapPlace::p_value);
  Struct<Detectable>(module, "Detectable", "The smallest size that would have been seen four times in five.")
      .result("effect", &Detectable::effect)
      .result("location", &Detectable::location)
      .result("smallest", &Detectable::smallest)
      .result("unit", &Detectable::unit);
  Struct<NotTestable>(module, "NotTestable", "An effect that these data cannot show, and why.")
      .result("effect", &NotTestable::effect)
      .result("location", &NotTestable::location)
      .result("why", &NotTestable::why);
  Struct<BadSample>(module, "BadSample", "A sample that belongs to no model.")
      .result("sample", &BadSample::sample)
      .result("residual", &BadSample::residual);
}

void bindFindings(py::module_& module) {
  Struct<AlternativeCause>(module, "AlternativeCause", "Another hypothesis that the data cannot exclude beside a finding.")
      .result("effect", &AlternativeCause::effect)
      .result("location", &AlternativeCause::location)
      .result("driver", &AlternativeCause::driver)
      .result("probability", &AlternativeCause::probability);
  Struct<Finding>(module, "Finding", "An effect at a place that the diagnosis holds to be real, with its size.")
      .result("effect", &Finding::effect)
      .result("location", &Finding::location)
      .result("driver", &Finding::driver)
      .result("parameters", &Finding::parameters)
      .result("standard_deviation", &Finding::standard_deviation)
      .result("units", &Finding::units)
      .result("probability", &Finding::probability)
      .result("p_value", &Finding::p_value)
      .result("log_evidence", &Finding::log_evidence)
      .result("shrinkage", &Finding::shrinkage)
      .result("alternatives", &Finding::alternatives)
      .result("separate_with", &Finding::separate_with)
      .result("reference", &Finding::reference)
      .result("largest_deflection", &Finding::largest_deflection)
      .result("largest_deflection_deviation", &Finding::largest_deflection_deviation)
      .result("remedy", &Finding::remedy)
      .result("images", &Finding::images);
}

void bindDiagnosis(py::module_& module) {
  bindGap(module);
  bindFindings(module);
  Struct<Diagnosis>(module, "Diagnosis", "Where the gap lies, which effect causes it, how far it shrinks.")
      .result("pixels", &Diagnosis::pixels)
      .result("noise_sigma", &Diagnosis::noise_sigma)
      .result("noise_source", &Diagnosis::noise_source)
      .result("noise_rms", &Diagnosis::noise_rms)
      .result("noise_bounds", &Diagnosis::noise_bounds)
      .result("stages", &Diagnosis::stages)
      .result("before_excess", &Diagnosis::before_excess)
      .result("after_excess", &Diagnosis::after_excess)
      .result("after_interval", &Diagnosis::after_interval)
      .result("shrinkage", &Diagnosis::shrinkage)
      .result("findings", &Diagnosis::findings)
      .result("possibilities", &Diagnosis::possibilities)
      .result("warnings", &Diagnosis::warnings)
      .result("where", &Diagnosis::where)
      .result("gap_remains", &Diagnosis::gap_remains)
      .result("remaining_significant", &Diagnosis::remaining_significant)
      .result("remaining_location", &Diagnosis::remaining_location)
      .result("remaining_driver", &Diagnosis::remaining_driver)
      .result("detectable", &Diagnosis::detectable)
      .result("not_testable", &Diagnosis::not_testable)
      .result("bad_samples", &Diagnosis::bad_samples)
      .result("model", &Diagnosis::model)
      .def("isClean", &Diagnosis::isClean)
      .def("noiseKnown", &Diagnosis::noiseKnown);
  py::enum_<TextLength>(module, "TextLength").value("kWhole", TextLength::kWhole).value("kScreen", TextLength::kScreen);
  module.def("diagnosisText", diagnosisText, py::arg("diagnosis"), py::arg("samples"),
             py::arg_v("length", TextLength::kWhole, "TextLength.kWhole"), "The diagnosis in sentences.");
  module.def("explainEffect", explainEffect, py::arg("diagnosis"), py::arg("effect"), "Why an effect was or was not chosen.");
}

void bindSummary(py::module_& module) {
  Struct<StageErrors>(module, "StageErrors",
                      "Errors of one model stage on held-out poses: rms [px], mean position [mm] and rotation [mrad].")
      .result("stage", &StageErrors::stage)
      .result("rms_px", &StageErrors::rms_px)
      .result("position", &StageErrors::position)
      .result("rotation", &StageErrors::rotation);
  Struct<FindingSummary>(module, "FindingSummary", "One finding of diagnosis.json in a few words.")
      .result("effect", &FindingSummary::effect)
      .result("location", &FindingSummary::location)
      .result("size", &FindingSummary::size)
      .result("driver", &FindingSummary::driver)
      .result("probability", &FindingSummary::probability)
      .result("alternatives", &FindingSummary::alternatives)
      .result("separate_with", &FindingSummary::separate_with);
  Struct<ResultSummary>(module, "ResultSummary", "What the results in a folder say in short.")
      .result("folder", &ResultSummary::folder)
      .result("name", &ResultSummary::name)
      .result("pictures", &ResultSummary::pictures)
      .result("pictures_with_corners", &ResultSummary::pictures_with_corners)
      .result("pictures_left_out", &ResultSummary::pictures_left_out)
      .result("registration_px", &ResultSummary::registration_px)
      .result("free_pose_px", &ResultSummary::free_pose_px)
      .result("poses", &ResultSummary::poses)
      .result("stages", &ResultSummary::stages)
      .result("verdict", &ResultSummary::verdict)
      .result("why", &ResultSummary::why)
      .result("findings", &ResultSummary::findings)
      .result("structure_left", &ResultSummary::structure_left)
      .result("gap_remains", &ResultSummary::gap_remains)
      .result("diagnosed", &ResultSummary::diagnosed)
      .result("shrinkage", &ResultSummary::shrinkage)
      .result("shrinkage_low", &ResultSummary::shrinkage_low)
      .result("shrinkage_high", &ResultSummary::shrinkage_high)
      .result("bad_samples", &ResultSummary::bad_samples)
      .result("bad_images", &ResultSummary::bad_images)
      .result("warnings", &ResultSummary::warnings)
      .result("corner_sigma_px", &ResultSummary::corner_sigma_px)
      .result("arm_beyond_tolerance", &ResultSummary::arm_beyond_tolerance)
      .def("isUnexplained", &ResultSummary::isUnexplained, "Whether something is left that no finding explains, of either kind.")
      .def("stage", &ResultSummary::stage, py::arg("stage"), py::return_value_policy::reference_internal,
           "The errors of a stage; None where it is not there.");
  module.def("readResults", readResults, py::arg("folder"), "Reads the results in a folder; none of the files need be there.");
  module.def("fleetColumns", fleetColumns, "What a row of fleet.csv holds.");
  module.def("fleetRow", fleetRow, py::arg("summary"), "The cells of a row by their columns.");
  module.def("fleetText", fleetText, py::arg("results"), "The results of many captures as a table for people.");
  module.def("fleetCsv", fleetCsv, py::arg("results"), "Text of fleet.csv.");
  module.def("fleetHtml", fleetHtml, py::arg("results"), py::arg("page"),
             "The results of many captures as one page; `page` is where it will stand, for its links.");
}

}  // namespace

void bindResults(py::module_& module) {
  bindErrorsOfModels(module);
  bindAdjustment(module);
  bindRegistration(module);
  bindIdentification(module);
  bindDiagnosis(module);
  py::enum_<ModelSource>(module, "ModelSource").value("kIdentified", ModelSource::kIdentified).value("kDiagnosed", ModelSource::kDiagnosed);
  Struct<Calibration>(module, "Calibration", "What a calibration gave; steps that were not done are None.")
      .result("registration", &Calibration::registration)
      .result("identification", &Calibration::identification)
      .result("diagnosis", &Calibration::diagnosis)
      .result("no_diagnosis", &Calibration::no_diagnosis)
      .result("model", &Calibration::model)
      .result("model_source", &Calibration::model_source)
      .result("model_reason", &Calibration::model_reason)
      .result("warnings", &Calibration::warnings);
  bindSummary(module);
  module.def("registrationYaml", registrationYaml, py::arg("calibration"), py::arg("measurements"), "Text of registration.yaml.");
  module.def("flangePosesCsv", flangePosesCsv, py::arg("calibration"), py::arg("measurements"), "Text of flange_poses.csv.");
  module.def("identificationJson", identificationJson, py::arg("identification"), py::arg("samples"), "Text of identification.json.");
  module.def("diagnosisJson", py::overload_cast<const Calibration&, const Measurements&>(diagnosisJson), py::arg("calibration"),
             py::arg("measurements"), "Text of diagnosis.json.");
}

}  // namespace poecal::python
