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

/// Where an arm and its measurements come from: a capture, or a robot with poses of any instrument.
struct ArmSource {
  CaptureSource capture;
  std::filesystem::path robot, poses;
  std::string base_link, tip_link;
};
void addArmSource(CLI::App& app, ArmSource& source, IdentifyOptions& options);
/// @throws InvalidArgument where neither was given.
void requireArmSource(const std::string& command, const ArmSource& source);

/// Adds the options that `identify` and `run` share.
void addIdentifyOptions(CLI::App& app, IdentifyOptions& options);
/// Of these the arm's tolerances.
void addToleranceOptions(CLI::App& app, IdentifyOptions& options);

/// Identifies the arm of a capture. @param registration  of the capture, where it was done already.
/// @throws InsufficientData without joint readings; else as identify().
Identification identifyInputs(const CaptureInputs& inputs, IdentifyOptions options, const RegistrationResult* registration = nullptr);
/// Identifies an arm from poses of any instrument.
Identification identifyTable(const Arm& arm, const PoseTable& table, IdentifyOptions options);
/// The poses of an instrument as what identify() fits.
std::vector<Observation> instrumentObservations(const PoseTable& table);

/// Identifies the arm of a capture; writes OUT/model.yaml and OUT/identification.json.
Identifying identifyCapture(const CaptureInputs& inputs, const IdentifyOptions& options, const std::filesystem::path& out,
                            const RegistrationResult* registration = nullptr);

/// Identifies an arm from poses of any instrument; writes the same files.
Identifying identifyPoses(const Arm& arm, const PoseTable& table, const IdentifyOptions& options, const std::filesystem::path& out);

}  // namespace poecal::app
