// The pose of a target from its corners in one picture: every candidate that the corners leave open.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {

/// A candidate pose, refined to the least reprojection error from its start.
struct TargetPose {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;  ///< sqrt(sum |r|^2 / N) over the corners
};

/// Candidates, best first. A planar target seen by a pinhole has two local minima (Collins and Bartoli 2014); both are kept, since noise
/// decides between them when the target is small or faces the camera. Fewer than 4 corners, or all on a line: none.
std::vector<TargetPose> targetPoses(const Camera& camera, const Observation& observation);

/// A pose of the target refined freely from a start, with covariance of its left perturbation (camera frame) at a scale of 1.
struct FreePose {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  double chi_square = 0.0;  ///< at the stated sigmas
  double rms_px = 0.0;
  Matrix6d covariance = Matrix6d::Zero();
  int corners = 0;
};
FreePose refinePose(const Camera& camera, const Observation& observation, const Eigen::Isometry3d& T_camera_target);

}  // namespace poecal
