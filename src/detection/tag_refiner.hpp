// AprilTag's corners made as exact as the picture allows, or refused where it does not support more.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "detection/tag_fit.hpp"
#include "detection/tag_pattern.hpp"
#include "poecal/camera/camera.hpp"

namespace poecal {

/// Standard deviation of AprilTag 3.3.0's own corners [px]: 0.055, which are 0.04 to 0.06 of mostly bias on clean pictures, and growing as
/// the side's inverse square below 40 px, where tags look too large (0.1 px at 30, 0.2 at 20).
double unrefinedSigma(const TagCorners& px);

class TagRefiner {
 public:
  /// @param bare_corners, border_bits  as TagPattern's. @param camera  its lens bends straight edges; nothing: they are taken as straight.
  /// @throws InvalidArgument for an unknown family.
  TagRefiner(std::string family, bool bare_corners, std::optional<Camera> camera, int border_bits = 1);

  /// Fits a tag to the picture, from corners that are about right on. Nothing where the tag is not wholly in the picture, the fit does not
  /// converge or moves a corner by more than a pixel, or what it finds cannot be a tag seen sharply: less contrast than 20 grey levels, a
  /// blur of half a cell, residuals of more than 6 % of the contrast, more than a fifth of the pixels unlike the model, or corners no
  /// better than AprilTag's.
  /// @param grey  8-bit, one channel.
  std::optional<TagFit> refine(const cv::Mat& grey, int id, const TagCorners& px);

 private:
  const TagPattern& patternOf(int id);

  std::string family_;
  bool bare_corners_;
  int border_bits_;
  std::optional<Camera> camera_;
  std::map<int, TagPattern> patterns_;
};

}  // namespace poecal
