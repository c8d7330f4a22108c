#include "geometry/pose_yaml.hpp"

#include <cmath>

#include <fmt/format.h>

#include "poecal/geometry/se3.hpp"

namespace poecal {

Eigen::Vector4d readUnitQuaternion(const YamlNode& node) {
  const Eigen::Vector4d quaternion = node.vector(4);
  if (std::abs(quaternion.norm() - 1.0) > 1e-3) {
    node.fail(fmt::format("length {:.6f}, expected a unit quaternion", quaternion.norm()));
  }
  return quaternion;
}

Eigen::Isometry3d readPose(const YamlNode& node) {
  node.checkKeys({"position", "quaternion_xyzw"});
  return poseFromQuaternion(node["position"].vector3(), readUnitQuaternion(node["quaternion_xyzw"]));
}

std::string yamlPose(const Eigen::Isometry3d& T) {
  return fmt::format("{{position: {}, quaternion_xyzw: {}}}", yamlVector(T.translation()), yamlVector(quaternionXyzw(T)));
}

}  // namespace poecal
