// Pictures of single tags to the last digit: areas of polygons instead of samples, the lens's blur before the pixel's square, and the limit
// that such a picture sets to any estimate of the corners. Shares no code with what is tested by it.
#pragma once

#include <string>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "poecal/core/random.hpp"
#include "support/rendering.hpp"

namespace poecal::test {

/// What a picture of one tag on white paper depends on.
struct TagScene {
  std::string family = "tag36h11";
  int id = 0;
  Quad corners = Quad::Zero();        ///< OpenCV's pixels
  double blur = 0.7;                  ///< of the lens, Gaussian, the pixel's square not included [px]
  double black = 30.0;                ///< [grey levels]
  double white = 208.0;               ///< [grey levels]
  Eigen::Vector2d shading{0.0, 0.0};  ///< change of the light over the picture's width and height, of 1
  cv::Size size{200, 200};
};

/// Mean grey value over each pixel's square, before noise and rounding, CV_32F: exact to 0.01 grey levels.
cv::Mat exactPicture(const TagScene& scene);

/// Gaussian noise of that standard deviation [grey levels], then rounding to 8 bits.
cv::Mat withNoise(const cv::Mat& exact, Rng& rng, double noise);

/// The Cramer-Rao limit: the least covariance of the corners, column by column, that any unbiased estimate can have from this picture at
/// that noise (rounding included), where blur, black and white are unknown as well. By differences of pictures.
Eigen::Matrix<double, 8, 8> cornerLimit(const TagScene& scene, double noise);

}  // namespace poecal::test
