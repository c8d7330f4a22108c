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

/// Diagnoses an identified capture; writes OUT/diagnosis.json, and OUT/model.yaml with the effects.
Diagnosing diagnoseCapture(const CaptureInputs& inputs, const Identification& identification, const IdentifyOptions& options,
                           const std::filesystem::path& out);

/// The same from poses of any instrument.
Diagnosing diagnosePoses(const PoseTable& table, const Identification& identification, const IdentifyOptions& options,
                         const std::filesystem::path& out);

}  // namespace poecal::app
