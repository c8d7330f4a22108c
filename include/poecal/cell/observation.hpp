// What was measured, one observation per sample: corners in a picture, or the pose that another instrument gave.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// A named point of the target seen at a pixel.
struct CornerMeasurement {
  PointId id;
  Eigen::Vector3d p_target = Eigen::Vector3d::Zero();
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  double sigma_px = 1.0;  ///< per axis; 1 where the detector states none, so that the scale of the fit is then the sigma
};

/// The pose of the target (or tool) before the camera (or instrument).
///
/// Its residual is e = (log(R_measured R_model^T); p_measured - p_model), axes of the camera frame, [rad; m].
struct PoseMeasurement {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  /// W with W^T W = inverse covariance of e, so that W e has unit covariance.
  Matrix6d whitening = Matrix6d::Identity();
  bool position_only = false;  ///< only p was measured; W is then diag(0, W_p)
};

/// All that one sample measured. Exactly one of `corners` and `pose` is filled.
struct Observation {
  std::size_t sample = 0;                          ///< index into the samples it came from
  Eigen::VectorXd q;                               ///< joint readings; empty where only the controller's flange pose is known
  std::optional<Eigen::Isometry3d> T_base_flange;  ///< the controller's pose; used where there is no arm
  std::vector<CornerMeasurement> corners;
  std::optional<PoseMeasurement> pose;
  /// Corners of tags in the same picture that never move, in their own frame: no part of any fit of the cell, but of what the diagnosis
  /// believes of a camera that moves. Empty where there are none.
  std::vector<CornerMeasurement> reference = {};

  /// Number of units that are weighted (and rejected) as one: each corner, or the pose.
  int unitCount() const { return pose ? 1 : static_cast<int>(corners.size()); }
  /// Numbers in a unit: 2 a corner, 6 a pose, 3 a position.
  int unitSize() const { return pose ? (pose->position_only ? 3 : 6) : 2; }
};

/// e = (log(R_measured R_model^T); p_measured - p_model) [rad; m], the residual of a pose.
Vector6d poseDifference(const Eigen::Isometry3d& T_measured, const Eigen::Isometry3d& T_model);

/// One picture's corners of the target as an observation; its sample's index is 0. Corners that the target does not have are left out.
Observation cornerObservation(const Sample& sample, const std::vector<Corner>& corners, const Target& target);
/// Joins samples and corners by image; samples without corners give no observation.
std::vector<Observation> cornerObservations(const SampleTable& table, const Detections& detections, const Target& target);

/// A measured pose as an observation; its sample's index is 0. @param sigma_position, sigma_rotation  where it states none [m], [rad].
Observation poseObservation(const MeasuredPose& measured, double sigma_position, double sigma_rotation);
/// Poses of an instrument as observations. @param sigma_position, sigma_rotation  where the table states none [m], [rad].
std::vector<Observation> poseObservations(const PoseTable& table, double sigma_position, double sigma_rotation);

}  // namespace poecal
