// Identification with its files and words, for `identify` and `run`.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "inputs.hpp"
#include "poecal/identification/identify.hpp"

namespace CLI {
class App;
}

namespace poecal::app {

struct Identifying {
  Identification identification;
  std::string text;
  nlohmann::json json;
};

/// Adds the options that `identify` and `run` share.
void addIdentifyOptions(CLI::App& app, IdentifyOptions& options);

/// Identifies the arm of a capture; writes OUT/model.yaml and OUT/identification.json.
Identifying identifyCapture(const CaptureInputs& inputs, IdentifyOptions options, const std::filesystem::path& out);

/// Identifies an arm from poses of any instrument; writes the same files.
Identifying identifyPoses(const Arm& arm, const PoseTable& table, IdentifyOptions options, const std::filesystem::path& out);

}  // namespace poecal::app
