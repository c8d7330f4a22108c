// How large an arm is, and sizes that none has: what is written in millimetres is a thousand times too large.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <fmt/format.h>

#include "poecal/geometry/se3.hpp"
#include "poecal/robot/arm.hpp"

namespace poecal {

constexpr double kLargestReach = 50.0;  ///< [m] the largest arms reach 20 m, and the smallest, of 5 cm, would be 50 m long in millimetres
constexpr double kLargestMass = 1e6;    ///< [kg]

/// What to say of a point of an arm too far from its base; nothing where it is not.
/// @param p_base  [m]; not finite counts as too far.
inline std::optional<std::string> sizeProblem(const Eigen::Vector3d& p_base) {
  const double reach = p_base.norm();
  if (reach <= kLargestReach) return std::nullopt;
  return fmt::format("is {:.2g} km from the base, expected metres: an arm in millimetres?", 1e-3 * reach);
}

/// How far an arm's axes and its flange reach from the base at zero [m].
inline double reachOf(const Arm& arm) {
  double reach = expSe3(arm.gamma).translation().norm();
  for (const Joint& joint : arm.joints) reach = std::max(reach, joint.anchor.norm());
  return reach;
}

}  // namespace poecal
