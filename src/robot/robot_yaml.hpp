// The map that describes an arm, as robot.yaml holds it at its top level and model.yaml under `robot:`.
#pragma once

#include <string>

#include "core/yaml.hpp"
#include "poecal/robot/arm.hpp"

namespace poecal {

/// Reads a map with the keys name, joints, flange and links, and no `format`: that belongs to a file of its own. The key
/// standard_deviation that an identification leaves beside the figures it estimated is allowed for the map and for each joint, and not
/// read.
/// @throws FileError as readRobotYaml.
Arm readRobotMap(const YamlNode& node);

/// Text of that map, each line indented by `indent` spaces and ended by a newline.
std::string robotMapYaml(const Arm& arm, int indent);

}  // namespace poecal
