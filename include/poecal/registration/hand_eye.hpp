// Hand-eye and base registration in closed form: T_camera_target = T_camera_near T_near_far T_far_target for a list of poses.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// The two constant transforms.
struct HandEye {
  Eigen::Isometry3d T_camera_near = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_far_target = Eigen::Isometry3d::Identity();
};

/// Closed-form solution from poses of the arm and of the target.
///
/// Rotation of T_camera_near: the rotation vectors of the relative motions, b_ij = R a_ij, by the orthogonal Procrustes solution (Park and
/// Martin 1994; pairs near half a turn are left out, where the sign of a rotation vector is lost). R_far_target: mean of
/// R_near_far^T R_camera_near^T R_camera_target. Translations: linear least squares.
///
/// Where all motions turn about one direction (a SCARA), the rotation about it follows from the translations instead, and sliding both
/// transforms along it is not determined: of all solutions it is the one whose part on the flange (T_far_target, or T_camera_near of a
/// camera in the hand) is shortest, as brackets are.
/// @return nothing where the arm never turns (fewer than two poses, or all of one orientation).
std::optional<HandEye> solveHandEye(const std::vector<Eigen::Isometry3d>& T_near_far, const std::vector<Eigen::Isometry3d>& T_camera_target,
                                    Setup setup);

/// The axis in near that all turns are about, where there is but one; nothing where there are none or more.
std::optional<Eigen::Vector3d> onlyAxis(const std::vector<Eigen::Isometry3d>& T_near_far);

/// How many independent directions the arm turned about: 0, 1 (a SCARA, or too timid a motion) or more (2 stands for two or three).
int rotationDirections(const std::vector<Eigen::Isometry3d>& T_near_far);

}  // namespace poecal
