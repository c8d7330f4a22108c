// Poses in YAML files: {position: [x, y, z], quaternion_xyzw: [x, y, z, w]}.
#pragma once

#include <string>

#include <Eigen/Geometry>

#include "core/yaml.hpp"

namespace poecal {

/// A list x, y, z, w. @throws FileError: not four numbers, or a length that is not 1 to 1e-3.
Eigen::Vector4d readUnitQuaternion(const YamlNode& node);
/// @throws FileError: other keys, or a quaternion whose length is not 1 to 1e-3 (it is normalised to the last digit).
Eigen::Isometry3d readPose(const YamlNode& node);
/// The pose on one line, with numbers that read back as the same bits.
std::string yamlPose(const Eigen::Isometry3d& T);

}  // namespace poecal
