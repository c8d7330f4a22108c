// How large an arm is, and sizes that none has: what is written in millimetres is a thousand times too large.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <fmt/format.h>

#include "poecal/core/text.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/robot/arm.hpp"

namespace poecal {

constexpr double kLargestReach = 50.0;   ///< [m] the largest arms reach 20 m, and the smallest, of 5 cm, would be 50 m long in millimetres
constexpr double kLargestMass = 2000.0;  ///< [kg] of one link: the heaviest arms weigh some tonnes in all
constexpr double kLargestTurn = 16.0 * std::numbers::pi;  ///< [rad] cables stand a few turns; half a turn in degrees is 180
constexpr double kLongestTravel = 100.0;                  ///< [m] of a track; a short quill in millimetres is longer

/// What to say of a point of an arm too far from its base; nothing where it is not.
/// @param p_base  [m]; not finite counts as too far.
inline std::optional<std::string> sizeProblem(const Eigen::Vector3d& p_base) {
  const double reach = p_base.norm();
  if (reach <= kLargestReach) return std::nullopt;
  return fmt::format("is {:.2g} km from the base, expected metres: an arm in millimetres?", 1e-3 * reach);
}

/// What to say of a mass that no link has; nothing where it is one. @param mass  [kg]; NaN is none.
inline std::optional<std::string> massProblem(double mass) {
  if (mass >= 0.0 && mass <= kLargestMass) return std::nullopt;
  if (mass < 0.0) return fmt::format("{} kg, expected 0 or more", formatNumber(mass));
  return fmt::format("{:.4g} kg, expected the mass of an arm's link: is it in grams?", mass);
}

/// What to say of joint limits that no joint has; nothing where one may have them.
inline std::optional<std::string> limitsProblem(JointType type, const JointLimits& limits) {
  const std::string range = fmt::format("{} to {}", formatNumber(limits.lower), formatNumber(limits.upper));
  if (!(limits.lower < limits.upper)) return range + ", expected lower < upper";
  const double furthest = std::max(std::abs(limits.lower), std::abs(limits.upper));
  if (type == JointType::kPrismatic) {
    if (furthest <= kLongestTravel) return std::nullopt;
    return range + ", expected metres: are they in millimetres?";
  }
  if (furthest <= kLargestTurn) return std::nullopt;
  return range + ", expected radians: are they in degrees? A joint without an end has no limits";
}

/// How far an arm's axes and its flange reach from the base at zero [m].
inline double reachOf(const Arm& arm) {
  double reach = expSe3(arm.gamma).translation().norm();
  for (const Joint& joint : arm.joints) reach = std::max(reach, joint.anchor.norm());
  return reach;
}

}  // namespace poecal
