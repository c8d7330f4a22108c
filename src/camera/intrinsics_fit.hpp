// Cameras fitted to pictures of a board: from nothing, and again with corners that do not belong losing their weight.
#pragma once

#include <vector>

#include "camera/board_bundle.hpp"
#include "poecal/camera/intrinsics.hpp"

namespace poecal {

inline constexpr std::size_t kLeastPictures = 3;

using Views = std::vector<const BoardView*>;

/// Pictures that take part, with the fit to them.
struct Solution {
  Views views;
  CornerWeights weights;  ///< empty: plain least squares
  CornerWeights trust;    ///< the share of `weights` that is from residuals
  std::vector<int> free;  ///< parameters that moved; the others are held at 0
  std::vector<int> held;  ///< coefficients that any value would fit, ascending
  BoardBundle start;      ///< focal lengths, centre and two coefficients only
  BoardBundleFit fit;

  /// Weighted number of corners.
  double cornerCount() const;
  /// Numbers that the residuals have beyond the unknowns.
  double freedoms() const;
  /// Standard deviation of one coordinate: sqrt(sum w |r|^2 / freedoms) [px].
  double sigma() const;
};

/// By plain least squares: focal lengths and the first coefficient, then the centre and the second, then all. A coefficient that the
/// pictures do not tell from zero while its deviation is beyond what a lens may have is held at 0.
/// @throws InsufficientData: fewer than 3 pictures, fewer numbers than unknowns.
Solution fitFromScratch(const Views& given, int width, int height, const IntrinsicsOptions& options);

/// The same for some of the views of `from`, each corner weighted by its distance in standard deviations of the noise (Hampel's
/// function: 1 up to 3, which one of 90 corners of normal noise exceeds, falling to 0 at 6), the noise by the median corner; and by the
/// sigmas that the views state, as IntrinsicsResult::robust says.
Solution fitRobustly(const Solution& from, const Views& views, const IntrinsicsOptions& options);

/// Residuals of a view and the weights of its corners, its pose fitted to a camera.
struct ViewFit {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  Eigen::Matrix2Xd residuals;
  Eigen::VectorXd weights;
};
/// @param sigma_px  noise of a coordinate; 0: by plain least squares, all weights 1. @return nothing where no pose was found.
std::optional<ViewFit> fitView(const Camera& camera, const BoardView& view, double sigma_px);

/// Standard deviation of one coordinate of normal noise whose distances have this median: median / sqrt(2 ln 2).
double sigmaOfMedian(double median_distance);

}  // namespace poecal
