#include "poecal/calibration/calibrate.hpp"

#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// The identification that a diagnosis starts from: where the lens was re-fitted though its file states no deviations, the fit with the
/// lens as stated. That the lens is wrong is then for the diagnosis to find.
const Identification& diagnosisStart(const Identification& identification) {
  return identification.with_stated_camera ? *identification.with_stated_camera : identification;
}

/// Keeps the diagnosed model where something was found, unless the identified one predicts held-out poses clearly better: where it
/// re-fitted a lens that no single effect mends, or where no model file can hold what is left.
void keepModel(const Identification& identification, Calibration& calibration) {
  constexpr double kClearly = 0.95;
  const Diagnosis& diagnosis = *calibration.diagnosis;
  if (diagnosis.findings.empty()) {
    calibration.model_reason =
        diagnosis.isClean() ? "nothing was found that it leaves out" : "no cause was found that helps on held-out poses";
    return;
  }
  const ErrorSummary& held_out = identification.stages.back().held_out_kept;
  const double identified = diagnosis.pixels ? held_out.px.rms : held_out.position.rms;
  if (identified > 0.0 && identified < kClearly * diagnosis.stages.back().rms) {
    calibration.model_reason =
        fmt::format("it predicts poses that it did not see to {}",
                    diagnosis.pixels ? fmt::format("{:.3f} px", identified) : fmt::format("{:.3f} mm", 1e3 * identified));
    return;
  }
  calibration.model = diagnosis.model;
  calibration.model_source = ModelSource::kDiagnosed;
  calibration.model_reason = "it holds the effects that were found";
}

void addDiagnosis(const Measurements& measurements, const CalibrateOptions& options, Calibration& calibration) {
  const Identification& identification = *calibration.identification;
  if (identification.method != Method::kBundle) {
    calibration.no_diagnosis = "it starts from method bundle";
    calibration.model_reason = calibration.no_diagnosis;
    return;
  }
  DiagnoseOptions diagnose_options = options.diagnose;
  diagnose_options.jobs = options.jobs;
  diagnose_options.progress = options.progress;
  try {
    calibration.diagnosis = diagnose(diagnosisStart(identification), measurements, diagnose_options);
  } catch (const InsufficientData& missing) {
    calibration.no_diagnosis = missing.what();
    calibration.model_reason = "there is no diagnosis";
    return;
  }
  calibration.warnings.insert(calibration.warnings.end(), calibration.diagnosis->warnings.begin(), calibration.diagnosis->warnings.end());
  keepModel(identification, calibration);
}

}  // namespace

void CalibrateOptions::validate() const {
  identify.validate();
  if (jobs < 0) throw InvalidArgument(fmt::format("jobs is {}, expected 0 (one per core) or more", jobs));
}

const char* modelSourceName(ModelSource source) { return source == ModelSource::kIdentified ? "identified" : "diagnosed"; }

Calibration calibrate(const Cell& nominal, const Measurements& measurements, const CalibrateOptions& options) {
  options.validate();
  if (measurements.observations.empty()) throw InsufficientData("nothing was measured: no pose to calibrate from");
  Cell cell = nominal;
  cell.registration = {
      .setup = measurements.setup, .known_near = nominal.registration.known_near, .known_far = nominal.registration.known_far};
  Calibration calibration;
  if (!measurements.observations.front().pose) {
    calibration.registration =
        registerCell(cell, measurements.observations, {.robust = options.identify.robust, .progress = options.progress});
    calibration.warnings = calibration.registration->warnings;
  }
  if (!cell.arm || options.last == CalibrationStep::kRegistration) return calibration;
  IdentifyOptions identify_options = options.identify;
  identify_options.jobs = options.jobs;
  identify_options.progress = options.progress;
  calibration.identification =
      identify(cell, measurements, identify_options, calibration.registration ? &*calibration.registration : nullptr);
  calibration.warnings = calibration.identification->warnings;  // the registration's among them
  calibration.model = calibration.identification->model;
  if (!measurements.target.points.empty()) calibration.model->target = measurements.target;
  if (options.last == CalibrationStep::kDiagnosis) addDiagnosis(measurements, options, calibration);
  return calibration;
}

}  // namespace poecal
