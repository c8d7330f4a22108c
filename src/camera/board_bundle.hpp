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

/// Weights of the corners of each view, not negative; no vectors at all: every corner has weight 1.
using CornerWeights = std::vector<Eigen::VectorXd>;

struct BoardBundleFit {
  BoardBundle estimate;
  double squared_error = 0.0;  ///< sum w |r|^2 [px^2]
  Eigen::MatrixXd
      information;  ///< of the free camera parameters, for noise of 1 px: J^T W J with the poses marginalised (Schur complement)
  /// How strongly whole pictures pull at the camera, against what independent noise of 1 px in the corners would let them:
  ///
  ///   sum_v g_v^T A^-1 g_v / sum_v tr(A^-1 (A_v - A_v A^-1 A_v)),   A = sum_v A_v the information, g_v the gradient of view v
  ///
  /// Its expectation is the variance of the noise [px^2] where that is all there is, and more where a board is not flat or the lens model
  /// lacks something. Zero without free parameters.
  double pull = 0.0;
  bool converged = false;
};

/// Residuals project(camera, T_camera_target p) - px of one picture; nothing where the camera cannot see one of the points.
std::optional<Eigen::Matrix2Xd> boardResiduals(const Camera& camera, const Eigen::Isometry3d& T_camera_target, const BoardView& view);

/// Levenberg-Marquardt from `start`; poses move by T <- exp(delta) T.
/// @param views  the pictures, one for each pose of `start`. @param free  indices of the camera parameters that move, ascending; may be
/// empty.
/// @param weights  one vector for each view, as long as it has corners; or none.
/// @return nothing where `start` itself has a point that its camera cannot see.
std::optional<BoardBundleFit> fitBoardBundle(const std::vector<const BoardView*>& views, const BoardBundle& start,
                                             const std::vector<int>& free, int max_iterations, const CornerWeights& weights = {});

}  // namespace poecal
