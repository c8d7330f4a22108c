// The ports of the cell: the places where a small disturbance can enter, and how each moves the pixels.
//
//   T_base_flange  = exp(b) exp(xi_1 (q_1 + d_1)) exp(l_1) ... exp(xi_n (q_n + d_n)) exp(l_n) exp(Gamma)
//   T_camera_target = exp(mount) T_camera_near T_near_far exp(grip) T_far_target
//   pixel_j = project(T_camera_target (p_j + shape_j); intrinsics + lens) + pixel shift_j
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/cell/cell.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {

/// What enters at every port for one sample; also a direction in which a sample's ports move.
///
/// Vectors are empty where nothing enters, or have one entry per joint, per intrinsic parameter or per point.
struct Disturbance {
  Eigen::VectorXd joints;               ///< d, added to the joint readings [rad] or [m]
  std::vector<Vector6d> links;          ///< l_k [rad; m], in the frame of body k, which is base at q = 0
  Vector6d base = Vector6d::Zero();     ///< b, before joint 1, in base
  Vector6d mount = Vector6d::Zero();    ///< left perturbation of T_camera_near, in camera
  Vector6d grip = Vector6d::Zero();     ///< left perturbation of T_far_target, in the far frame
  Eigen::VectorXd intrinsics;           ///< added to Camera::parameters()
  std::vector<Eigen::Vector3d> points;  ///< shape: added to the points in target [m]
  std::vector<Eigen::Vector2d> pixels;  ///< added to the pixels [px]

  /// All vectors of full length and zero. @param points  number of points of the sample.
  static Disturbance zero(const Cell& cell, std::size_t points);
};

/// T_base_flange of a sample with the disturbance of its joints, links and base; without disturbance the bits of Cell::baseFlange.
/// @throws InvalidArgument if the sample has no pose, a vector is of another length, or joints and links are disturbed where there is no
/// arm.
Eigen::Isometry3d disturbedFlange(const Cell& cell, const Sample& sample, const Disturbance& disturbance);

/// T_camera_target likewise, with mount and grip. @throws InvalidArgument as disturbedFlange.
Eigen::Isometry3d disturbedTarget(const Cell& cell, const Sample& sample, const Disturbance& disturbance);

/// The camera with its intrinsics disturbed. @throws InvalidArgument if the cell has no camera or the vector another length.
Camera disturbedCamera(const Cell& cell, const Disturbance& disturbance);

/// Pixels of points with every disturbance; nothing where the lens model has no pixel (see project()).
/// @param points  in the order of disturbance.points and .pixels. @throws InvalidArgument as the functions above.
std::vector<std::optional<Eigen::Vector2d>> disturbedCorners(const Cell& cell, const Sample& sample, const std::vector<TargetPoint>& points,
                                                             const Disturbance& disturbance);

/// Derivatives of T_camera_target (left perturbation in camera, 6 numbers) by the ports that act through it.
struct PosePortJacobian {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  Matrix6Xd joints;             ///< 6 x n
  std::vector<Matrix6d> links;  ///< n of 6 x 6
  Matrix6d base = Matrix6d::Identity();
  Matrix6d mount = Matrix6d::Identity();
  Matrix6d grip = Matrix6d::Identity();

  /// Motion of T_camera_target (w; v) in camera, for a direction in which the ports move.
  Vector6d along(const Disturbance& direction) const;
};

/// Derivatives of the pixels of m points by every port.
struct PortJacobian {
  PosePortJacobian pose;
  Eigen::Matrix<double, Eigen::Dynamic, 6> J_px_pose;    ///< 2m x 6, by T_camera_target
  std::vector<Eigen::Matrix<double, 2, 3>> J_px_points;  ///< m of 2 x 3, each pixel by its own point
  Eigen::MatrixXd J_px_intrinsics;                       ///< 2m x parameterCount()
  std::vector<bool> valid;                               ///< per point: it has a pixel; otherwise its rows are zero

  /// d(pixels), 2m, for a direction in which the ports move; a point's own pixel port moves it one to one.
  Eigen::VectorXd along(const Disturbance& direction) const;
};

/// Derivatives at a disturbance. @throws InvalidArgument as disturbedTarget.
PosePortJacobian posePortJacobian(const Cell& cell, const Sample& sample, const Disturbance& at = {});
/// Derivatives at a disturbance. @throws InvalidArgument as disturbedCorners.
PortJacobian portJacobian(const Cell& cell, const Sample& sample, const std::vector<TargetPoint>& points, const Disturbance& at = {});

}  // namespace poecal
