// The pixels of a picture that tell where a tag's edges lie.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "detection/lens_patch.hpp"
#include "detection/plane_map.hpp"
#include "detection/tag_appearance.hpp"
#include "detection/tag_pattern.hpp"

namespace poecal {

struct EdgePixel {
  Eigen::Vector2d px_straight = Eigen::Vector2d::Zero();  ///< behind the lens [px]
  TagView view;                                           ///< what a step of less than a pixel leaves nearly as it is, but for `uv`
  Eigen::Vector2d unit = Eigen::Vector2d::Zero();         ///< position in the box of the tag, -1 to 1, for shading
  double grey = 0.0;                                      ///< of 255
};

/// Those of every `stride`th row and column within 2.5 blurs of an edge, further than 3 blurs from what is not known; in rows from the top.
/// @param grey  8-bit, one channel. @param lens  covers the tag. @param map  from the pattern's corners. @param blur  [px].
std::vector<EdgePixel> edgePixels(const cv::Mat& grey, const TagPattern& pattern, const LensPatch& lens, const PlaneMap& map, double blur,
                                  int stride);

}  // namespace poecal
