// The key `gravity` of capture.yaml and model.yaml.
#pragma once

#include <Eigen/Core>

#include "core/yaml.hpp"

namespace poecal {

/// Gravity in base [m/s^2]. @throws FileError where it is not as strong as on Earth.
Eigen::Vector3d readGravity(const YamlNode& node);

}  // namespace poecal
