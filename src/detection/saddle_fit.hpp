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
  /// The place seen at a pixel: within 1e-4 squares of pixelOf()'s inverse in the squares beside the corner.
  /// @param J_squares_px  inverse of J_px_squares.
  Eigen::Vector2d squaresAt(const Eigen::Vector2d& px, const Eigen::Matrix2d& J_squares_px) const;
};

/// What a picture looks like about a corner.
struct SaddleLook {
  PointSpread spread;   ///< the pixel's own square included
  double growth = 0.0;  ///< of dark into light, to each side [px]
  /// Black and its slopes, then contrast and its slopes, over half the patch [grey levels].
  Eigen::Matrix<double, 6, 1> light = Eigen::Matrix<double, 6, 1>::Zero();
  double noise = 0.0;  ///< robust standard deviation of the residuals [grey levels]; 0: not known yet, and neither is light

  double contrast() const { return light(3); }  ///< white - black at the corner [grey levels]
};

struct SaddleFit {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of px [px^2]; see fitSaddle()
  SaddleLook look;
  double outliers = 0.0;  ///< share of pixels further than three times `noise` from the model

  double sigma() const;  ///< rms of both axes [px]
};

/// Minimises over the corner, the directions of its two edges, point spread, growth and light, by Gauss-Newton steps, the same model of a
/// blurred pattern as fitTag()'s. How the edges bend is taken from the view. Pixels are those within half a square along both directions:
/// all within 2.5 blurs of an edge and some of the others, which tell the light. So each edge's pixels belong to the nearer of its corners,
/// and errors are independent. Residuals beyond three standard deviations lose weight by Huber's function.
/// The covariance is that of least squares at the variance of the residuals, times their coherence along the edges where that is more than
/// noise has: a print whose edges do not meet in a point, glare, a shadow.
/// @param grey  8-bit, one channel. @param view  within a pixel or two of the answer. @param start  of the fit. @param stride  every how
/// many rows and columns pixels are taken.
/// @return nothing where it does not converge, or too few pixels are there.
std::optional<SaddleFit> fitSaddle(const cv::Mat& grey, const SaddleCells& cells, const SaddleView& view, const SaddleLook& start,
                                   int stride);

}  // namespace poecal
