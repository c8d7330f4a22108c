// The whole cell as one forward model: joint reading -> pose of the target before the camera -> pixel.
//
//   T_camera_target = T_camera_near T_near_far(q) T_far_target
//
// `near` is the end of the arm on the camera's side, `far` the one on the target's: (base, flange) for eye_to_hand with
// T_near_far = T_base_flange(q), (flange, base) for eye_in_hand with T_near_far = inv(T_base_flange(q)). For poses of another
// instrument, `camera` is that instrument and `target` the tool that it measures.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/robot/arm.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// What is known of a constant transform before anything is measured.
struct KnownTransform {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  /// 1 sigma of a left perturbation (rotation; translation) in the first-named frame [rad; m]; infinity where nothing is known.
  Eigen::Matrix<double, 6, 1> sigma = Eigen::Matrix<double, 6, 1>::Constant(kFixed);

  /// Sigma of a transform that is fixed: far below what any arm or camera shows.
  static constexpr double kFixed = 1e-7;
};

/// The two constant transforms around the arm.
struct Registration {
  Setup setup = Setup::kEyeToHand;
  Eigen::Isometry3d T_camera_near = Eigen::Isometry3d::Identity();  ///< T_camera_base, or T_camera_flange in hand
  Eigen::Isometry3d T_far_target = Eigen::Isometry3d::Identity();   ///< T_flange_target, or T_base_target in hand

  /// Priors of both, which every fit that moves them takes in.
  std::optional<KnownTransform> known_near = {}, known_far = {};

  const char* nearFrame() const;  ///< "base" or "flange"
  const char* farFrame() const;   ///< "flange" or "base"
  /// T_camera_target for a pose of the flange.
  Eigen::Isometry3d cameraTarget(const Eigen::Isometry3d& T_base_flange) const;
  /// T_base_flange for a measured pose of the target.
  Eigen::Isometry3d baseFlange(const Eigen::Isometry3d& T_camera_target) const;
  /// T_camera_base at a pose of the flange.
  Eigen::Isometry3d cameraBase(const Eigen::Isometry3d& T_base_flange) const;
};

/// Everything that turns a joint reading into pixels.
struct Cell {
  std::optional<Arm> arm;        ///< unset where only flange poses are known
  std::optional<Camera> camera;  ///< unset for poses of another instrument
  Registration registration;

  /// The arm's T_base_flange(q), or the controller's pose where there is no arm. @throws InvalidArgument if the sample has neither.
  Eigen::Isometry3d baseFlange(const Sample& sample) const;
};

/// Pixels of the target's points that the camera can see from the front of the model (see project()), sorted by id; not clipped to the
/// picture.
/// @throws InvalidArgument if the cell has no camera.
std::vector<Corner> predictCorners(const Cell& cell, const Target& target, const Eigen::Isometry3d& T_base_flange);

}  // namespace poecal
