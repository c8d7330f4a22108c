// The tag that explains the grey values about it best: corners, blur, growth of dark into light, and light.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "detection/lens_patch.hpp"
#include "detection/plane_map.hpp"
#include "detection/tag_appearance.hpp"
#include "detection/tag_pattern.hpp"
#include "poecal/capture/picture_look.hpp"

namespace poecal {

struct TagFit {
  TagCorners px = TagCorners::Zero();
  Eigen::Matrix<double, 8, 8> covariance = Eigen::Matrix<double, 8, 8>::Zero();  ///< of px column by column; see fitTag()
  PointSpread spread;                                                            ///< the pixel's own square included
  double growth = 0.0;                                                           ///< of dark into light, to each side [px]
  double contrast = 0.0;                                                         ///< white - black in the middle of the tag [grey levels]
  double noise = 0.0;     ///< robust standard deviation of the residuals [grey levels]
  double outliers = 0.0;  ///< share of pixels further than three times `noise` from the model
  int pixels = 0;

  /// Of each corner, rms of both axes [px].
  Eigen::Vector4d sigmas() const;
  /// What the picture looks like about the tag: without the pixel's own square in the blur, without rounding in the noise.
  PictureLook look() const;
};

/// Minimises over corners c, point spread s, growth h and light (b, k), by iteratively reweighted Gauss-Newton steps,
///   sum_px w (grey - b(px) - k(px) whiteness(G(px; c); s, h))^2,
/// b and k linear over the tag, G the homography that takes the corners, straightened by the lens, to those of the pattern, and
/// w = 1 within three standard deviations of the residuals, (3 sigma / r)^2 outside: glare and dirt lose their pull.
/// Pixels far from any edge do not count, nor do those that the blur mixes with what is not known.
/// The covariance is that of least squares at the variance of the residuals, times the residuals' coherence where that is more than 1: how
/// much more they agree along the pattern's lines than noise would, as they do where the picture was filtered after sampling or the print
/// is not as drawn.
/// @param grey   8-bit, one channel.
/// @param start  within a pixel or two of the answer.
/// @return nothing where it does not converge or too few pixels are there.
std::optional<TagFit> fitTag(const cv::Mat& grey, const TagPattern& pattern, const TagCorners& start, const LensPatch& lens);

}  // namespace poecal
