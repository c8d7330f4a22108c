// Pictures of flat targets with corners known exactly, and how far found corners are from them.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "poecal/capture/detections.hpp"
#include "poecal/core/random.hpp"

namespace poecal::test {

using Quad = Eigen::Matrix<double, 2, 4>;

/// Draws `texture` so that its point texture_quad.col(k) comes to picture_quad.col(k), both in OpenCV's pixels (integers are centres).
/// Each pixel of `picture` is the mean of 8 x 8 points over its square. What lies outside of the texture stays.
void drawTexture(cv::Mat& picture, const cv::Mat& texture, const Quad& texture_quad, const Quad& picture_quad);
/// The same homography for single points.
Eigen::Matrix2Xd mapPoints(const Eigen::Matrix2Xd& points, const Quad& texture_quad, const Quad& picture_quad);

/// The upright tag as the library of its family draws it, one pixel a bit, and the outer corners of its black border (or white one of
/// the families whose border is reversed) in the contract's order: bottom-left, bottom-right, top-right, top-left.
struct TagTexture {
  cv::Mat texture;
  Quad corners;
};
TagTexture tagTexture(const std::string& family, int id);

/// A grey picture with one tag drawn at `corners`.
cv::Mat tagPicture(const std::string& family, int id, const Quad& corners, cv::Size size = {640, 480});

/// Corners of a square of about `side` pixels at `centre`, turned by `angle` in the picture and tilted out of it in perspective.
Quad tiltedSquare(const Eigen::Vector2d& centre, double side, double angle, double tilt);

/// Blur and noise as a lens and a sensor add them.
void degrade(cv::Mat& picture, Rng& rng, double blur, double noise);

/// Mean and root mean square deviation about the mean, per axis [px].
struct CornerErrors {
  std::vector<Eigen::Vector2d> errors;
  Eigen::Vector2d mean() const;
  double rmsAboutMean() const;
  double largest() const;
};

}  // namespace poecal::test
