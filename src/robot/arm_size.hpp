// Sizes that no arm has: what is written in millimetres is a thousand times too large.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <fmt/format.h>

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

}  // namespace poecal
