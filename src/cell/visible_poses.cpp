#include "cell/visible_poses.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "cell/sight.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

constexpr double kPictureMargin = 0.05;       ///< of the picture's width and height
constexpr double kSmallestTagSide = 40.0;     ///< [px]
constexpr double kSmallestSquareSide = 15.0;  ///< [px]
const double kSquarelyCos = std::cos(std::numbers::pi / 3.0);

}  // namespace

std::vector<JointLimits> readingRanges(const Arm& arm, const std::filesystem::path& robot_file) {
  std::vector<JointLimits> ranges;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const Joint& joint = arm.joints[k];
    const bool revolute = joint.type == JointType::kRevolute;
    if (!revolute && !joint.limits) {
      throw FileError(
          robot_file, 0,
          fmt::format("joint {} ({}) is prismatic without limits, expected limits to draw its readings from", k + 1, joint.name));
    }
    JointLimits range = joint.limits.value_or(JointLimits{-std::numbers::pi, std::numbers::pi});
    if (revolute && range.upper - range.lower > 2.0 * std::numbers::pi) {
      const double middle = 0.5 * (range.lower + range.upper);
      range = {middle - std::numbers::pi, middle + std::numbers::pi};
    }
    ranges.push_back(range);
  }
  return ranges;
}

Eigen::VectorXd drawReading(const std::vector<JointLimits>& ranges, Rng& rng) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(ranges.size()));
  for (std::size_t k = 0; k < ranges.size(); ++k) q(static_cast<Eigen::Index>(k)) = rng.uniform(ranges[k].lower, ranges[k].upper);
  return q;
}

bool wellInView(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target) {
  const double smallest_side = target.hasTags() ? kSmallestTagSide : kSmallestSquareSide;
  bool any_faces = false;
  for (const FaceSight& sight : sightOf(camera, target, T_camera_target)) {
    if (!sight.complete || !inPicture(camera, sight.corners, kPictureMargin)) return false;
    any_faces = any_faces || (sight.facing_cos >= kSquarelyCos && sight.shortest_side_px >= smallest_side);
  }
  return any_faces;
}

}  // namespace poecal
