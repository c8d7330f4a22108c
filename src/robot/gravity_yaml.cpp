#include "robot/gravity_yaml.hpp"

#include <cmath>

#include <fmt/format.h>

namespace poecal {

Eigen::Vector3d readGravity(const YamlNode& node) {
  constexpr double kOnEarth = 9.8;    // [m/s^2], by 0.3 % less or more from place to place
  constexpr double kRounding = 0.03;  // 10 m/s^2 is a rounding that people use
  const Eigen::Vector3d gravity = node.vector3();
  if (!(std::abs(gravity.norm() - kOnEarth) <= kRounding * kOnEarth)) {
    node.fail(fmt::format("has length {:.4g}, expected 9.8: gravity in the base frame [m/s^2]", gravity.norm()));
  }
  return gravity;
}

}  // namespace poecal
