// The map of target.yaml, as a file of its own and inside other YAML files.
#pragma once

#include <string>

#include "core/yaml.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// @throws FileError as readTarget.
Target parseTarget(const YamlNode& node);

/// The lines of the map, each after `indent` and with its end of line.
std::string targetYamlLines(const Target& target, const std::string& indent);

}  // namespace poecal
