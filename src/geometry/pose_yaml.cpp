#include "geometry/pose_yaml.hpp"

#include <cmath>

#include <fmt/format.h>

#include "poecal/geometry/se3.hpp"

namespace poecal {

Eigen::Isometry3d readPose(const YamlNode& node) {
  node.checkKeys({"position", "quaternion_xyzw"});
  const YamlNode quaternion_node = node["quaternion_xyzw"];
  const Eigen::Vector4d quaternion = quaternion_node.vector(4);
  if (std::abs(quaternion.norm() - 1.0) > 1e-3) {
    quaternion_node.fail(fmt::format("length {:.6f}, expected a unit quaternion", quaternion.norm()));
  }
  return poseFromQuaternion(node["position"].vector3(), quaternion);
}

std::string yamlPose(const Eigen::Isometry3d& T) {
  return fmt::format("{{position: {}, quaternion_xyzw: {}}}", yamlVector(T.translation()), yamlVector(quaternionXyzw(T)));
}

}  // namespace poecal
