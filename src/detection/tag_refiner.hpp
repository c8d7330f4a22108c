// AprilTag's corners made as exact as the picture allows, or left as they are where it does not support more.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "detection/tag_detector.hpp"
#include "detection/tag_fit.hpp"
#include "detection/tag_pattern.hpp"
#include "poecal/camera/camera.hpp"

namespace poecal {

struct RefinedTag {
  TagCorners px = TagCorners::Zero();
  Eigen::Vector4d sigma = Eigen::Vector4d::Zero();  ///< of each corner, rms of both axes [px]
  std::optional<TagFit> fit;                        ///< nothing where the corners are AprilTag's
};

/// Standard deviation of AprilTag 3.3.0's own corners [px]: 0.055, which are 0.04 to 0.06 of mostly bias on clean pictures, and growing as
/// the side's inverse square below 40 px, where tags look too large (0.1 px at 30, 0.2 at 20).
double unrefinedSigma(const TagDetection& tag);

/// AprilTag's corners as they are, with unrefinedSigma().
RefinedTag unrefined(const TagDetection& tag);

class TagRefiner {
 public:
  /// @param bare_corners  as TagPattern's. @param camera  its lens bends straight edges; nothing: they are taken as straight.
  /// @throws InvalidArgument for an unknown family.
  TagRefiner(std::string family, bool bare_corners, std::optional<Camera> camera);

  /// Fits the tag to the picture, from AprilTag's corners on. Refused, that is AprilTag's corners with unrefinedSigma(), where the tag
  /// is not wholly in the picture, the fit does not converge or moves a corner by more than a pixel, or what it finds cannot be a tag seen
  /// sharply: less contrast than 20 grey levels, a blur of half a cell, residuals of more than 6 % of the contrast, more than a fifth of
  /// the pixels unlike the model, or corners no better than AprilTag's.
  /// @param grey  8-bit, one channel.
  RefinedTag refine(const cv::Mat& grey, const TagDetection& tag);

 private:
  std::optional<TagFit> fit(const cv::Mat& grey, const TagDetection& tag);
  const TagPattern& patternOf(int id);

  std::string family_;
  bool bare_corners_;
  std::optional<Camera> camera_;
  std::map<int, TagPattern> patterns_;
};

}  // namespace poecal
