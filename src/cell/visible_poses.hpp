// Joint readings drawn at random, and which of them show the target well: one rule for what is simulated and what is planned.
#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/core/random.hpp"
#include "poecal/robot/arm.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// Ranges to draw readings from [rad] or [m]: the limits; of a revolute joint +-pi where it has none, and at most half a turn either way of
/// their middle. @param robot_file  named by the error. @throws FileError: a prismatic joint without limits.
std::vector<JointLimits> readingRanges(const Arm& arm, const std::filesystem::path& robot_file);

/// A reading, uniform within the ranges, one joint after the other.
Eigen::VectorXd drawReading(const std::vector<JointLimits>& ranges, Rng& rng);

/// A pose worth taking: the whole target is before the camera and in the picture, 5 % of its width and height away from the borders, and
/// faces the camera within 60 degrees with tags' sides of at least 40 px (a board's squares: 15 px); of several tags one must.
bool wellInView(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target);

}  // namespace poecal
