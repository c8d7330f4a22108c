// What the YAML manifests of a capture and of a scene share: files by name, the setup, and the robot in either of its formats.
#pragma once

#include <filesystem>
#include <string>

#include "core/yaml.hpp"
#include "poecal/capture/capture.hpp"

namespace poecal {

/// The file that a key names, relative to the manifest's folder. @throws FileError where it is not there.
std::filesystem::path namedFile(const YamlNode& node);
/// Likewise a folder.
std::filesystem::path namedFolder(const YamlNode& node);

/// @throws FileError for another text than eye_to_hand and eye_in_hand.
Setup readSetup(const YamlNode& node);

struct NamedRobot {
  Arm arm;
  std::filesystem::path file;
  std::string base_link, tip_link;  ///< URDF only
};

/// The keys `robot`, `base_link` and `tip_link` of a manifest; nothing where it has no robot.
/// @throws FileError as readRobotYaml and readUrdf; links named without a URDF, or a URDF without them.
std::optional<NamedRobot> readNamedRobot(const YamlNode& root);

}  // namespace poecal
