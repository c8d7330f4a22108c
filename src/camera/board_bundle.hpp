// Least squares over one camera and the pose of the board in each picture.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/camera/intrinsics.hpp"

namespace poecal {

/// What is estimated.
struct BoardBundle {
  Camera camera;
  std::vector<Eigen::Isometry3d> T_camera_target;  ///< one per view
};

struct BoardBundleFit {
  BoardBundle estimate;
  double squared_error = 0.0;   ///< sum |r|^2 [px^2]
  Eigen::MatrixXd information;  ///< of the free camera parameters, for noise of 1 px: J^T J with the poses marginalised (Schur complement)
  bool converged = false;
};

/// Residuals project(camera, T_camera_target p) - px of one picture; nothing where the camera cannot see one of the points.
std::optional<Eigen::Matrix2Xd> boardResiduals(const Camera& camera, const Eigen::Isometry3d& T_camera_target, const BoardView& view);

/// Levenberg-Marquardt from `start`; poses move by T <- exp(delta) T.
/// @param views  the pictures, one for each pose of `start`. @param free  indices of the camera parameters that move, ascending; may be
/// empty.
/// @return nothing where `start` itself has a point that its camera cannot see.
std::optional<BoardBundleFit> fitBoardBundle(const std::vector<const BoardView*>& views, const BoardBundle& start,
                                             const std::vector<int>& free, int max_iterations);

}  // namespace poecal
