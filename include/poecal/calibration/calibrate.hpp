// The main job, from measurements in memory: registration, identification and diagnosis of a cell.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/measurements.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/diagnosis/diagnose.hpp"
#include "poecal/identification/identify.hpp"
#include "poecal/registration/registration.hpp"

namespace poecal {

/// How far a calibration goes. Each step needs those before it.
enum class CalibrationStep { kRegistration, kIdentification, kDiagnosis };

struct CalibrateOptions {
  CalibrationStep last = CalibrationStep::kDiagnosis;
  IdentifyOptions identify = {};
  DiagnoseOptions diagnose = {};
  /// Fits worked on at a time (0: one per core); the result does not depend on it.
  int jobs = 1;
  /// Told of every step; may be empty. Those of `identify` and `diagnose` are not asked.
  ProgressFunction progress = {};
  void validate() const;  ///< @throws InvalidArgument with the field's name and value.
};

/// Where a kept model comes from.
enum class ModelSource { kIdentified, kDiagnosed };
/// "identified", "diagnosed".
const char* modelSourceName(ModelSource source);

/// What a calibration gave. Steps that were not done are unset.
struct Calibration {
  std::optional<RegistrationResult> registration;  ///< corners only; with poses of an instrument it is part of the identification
  std::optional<Identification> identification;    ///< unset where the cell has no arm
  std::optional<Diagnosis> diagnosis;
  std::string no_diagnosis;  ///< why there is none though it was asked for; one clause, no full stop

  /// The model to use from now on; unset where the cell has no arm.
  std::optional<Model> model;
  ModelSource model_source = ModelSource::kIdentified;
  std::string model_reason;  ///< why this model and not the other; one clause

  std::vector<std::string> warnings;  ///< of all steps, one sentence each
};

/// Calibrates a cell.
///
/// @param nominal  the arm as drawn, none where only the controller's flange poses are known; the camera as stated, none where an
///   instrument measured poses. Of its registration what is known of the transforms is used, no more.
/// @throws InsufficientData: too few poses for the unknowns, a joint that never moved, poses that do not turn the target. A capture that
///   is too small for a diagnosis alone is no error: `no_diagnosis` says so.
/// @throws ImplausibleInput: measurements that contradict each other, with what is suspected.
Calibration calibrate(const Cell& nominal, const Measurements& measurements, const CalibrateOptions& options = {});

}  // namespace poecal
