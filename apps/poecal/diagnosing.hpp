// The diagnosis with its files and words, for `diagnose` and `run`.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "identifying.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal::app {

struct Diagnosing {
  Diagnosis diagnosis;
  std::string text;
  nlohmann::json json;
};

/// The fit that a diagnosis of a capture starts from: to all poses, as the diagnosis holds out poses itself, and with a lens of unstated
/// deviations taken as stated: that it is wrong is for the diagnosis to say.
/// @param identification  of the capture, where it was done already; it serves where it is such a fit.
Identification diagnosisStart(const CaptureInputs& inputs, const IdentifyOptions& options, const Identification* identification = nullptr);
/// The same of poses of an instrument.
Identification diagnosisStart(const Arm& arm, const PoseTable& table, const IdentifyOptions& options);

/// Diagnoses a capture; writes OUT/diagnosis.json, and OUT/model.yaml with the effects.
Diagnosing diagnoseCapture(const CaptureInputs& inputs, const Identification& start, const IdentifyOptions& options,
                           const std::filesystem::path& out);

/// What `identify` leaves for a diagnosis to be held against.
struct IdentifiedModel {
  double held_out_px = 0.0;  ///< rms on poses that the fit did not see; NaN where none was held out
  std::string model_yaml;
};
IdentifiedModel identifiedModel(const Identification& identification);
/// The same from FOLDER/identification.json and FOLDER/model.yaml. @throws FileError where they are not what identify writes.
IdentifiedModel readIdentifiedModel(const std::filesystem::path& folder);

/// As diagnoseCapture(), but OUT/model.yaml is the identified one where that predicts unseen poses clearly better: it re-fitted a lens that
/// no single effect mends, or what is left is of a shape that no model file can hold. So it is where the capture is too small for a
/// diagnosis, which text and diagnosis.json (verdict: insufficient data, why: ...) then say.
Diagnosing diagnoseIdentified(const CaptureInputs& inputs, const Identification& start, const IdentifiedModel& identified,
                              const IdentifyOptions& options, const std::filesystem::path& out);

/// The same from poses of any instrument.
Diagnosing diagnosePoses(const PoseTable& table, const Identification& identification, const IdentifyOptions& options,
                         const std::filesystem::path& out);

}  // namespace poecal::app
