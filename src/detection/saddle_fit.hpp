// The crossing of two edges of a board that explains the grey values about it best.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "detection/saddle_cells.hpp"
#include "detection/tag_appearance.hpp"

namespace poecal {

/// The board's plane about a corner, to second order: the point (u, v) from it [squares] is seen at
///   px + J (u, v) + uu u^2 + uv u v + vv v^2.
struct SaddleView {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d J_px_squares = Eigen::Matrix2d::Identity();  ///< [px / square]
  Eigen::Vector2d uu = Eigen::Vector2d::Zero(), uv = uu, vv = uu;
  DarkPair dark = DarkPair::kMain;

  Eigen::Vector2d pixelOf(const Eigen::Vector2d& squares) const;
  /// 2 x 2, derivative of pixelOf() [px / square].
  Eigen::Matrix2d pixelsPerSquare(const Eigen::Vector2d& squares) const;
  /// The place seen at a pixel, by two steps of Newton's method: within 1e-4 squares of pixelOf()'s inverse in the squares beside the
  /// corner.
  Eigen::Vector2d squaresAt(const Eigen::Vector2d& px) const;
};

struct SaddleFit {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of px [px^2]
  PointSpread spread;                                    ///< the pixel's own square included
  double growth = 0.0;                                   ///< of dark into light, to each side [px]
  double contrast = 0.0;                                 ///< [grey levels]
  double noise = 0.0;                                    ///< robust standard deviation of the residuals [grey levels]
  double outliers = 0.0;                                 ///< share of pixels further than three times `noise` from the model

  double sigma() const;  ///< rms of both axes [px]
};

/// Minimises over the corner, the directions of its two edges, point spread, growth and light, by iteratively reweighted Gauss-Newton
/// steps, the same model of a blurred pattern as fitTag()'s. How the edges bend is taken from the view. Pixels are those within half a
/// square along both directions and 2.5 blurs of an edge; so each edge's pixels belong to the nearer of its corners, and errors are
/// independent.
/// @param grey  8-bit, one channel. @param view  within a pixel or two of the answer. @param spread, stride  where to start, and whether on
/// every `stride`th row and column only.
/// @return nothing where it does not converge, or too few pixels are there.
std::optional<SaddleFit> fitSaddle(const cv::Mat& grey, const SaddleCells& cells, const SaddleView& view, const PointSpread& spread,
                                   int stride);

}  // namespace poecal
