// Pictures of chessboards and ChArUco boards to the last digit, behind any lens, and the limit that such a picture sets to any estimate of
// a corner. Shares no code with what is tested by it.
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace poecal::test {

/// What a picture of a board on white paper depends on.
struct ExactBoard {
  int cols = 10, rows = 7;                                         ///< squares; the first one is dark
  std::optional<int> dictionary;                                   ///< OpenCV's, of the markers in the light squares; nothing: none
  double marker = 0.0;                                             ///< side [squares]
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> pixelOf;  ///< of a place on the board [squares], from its outer corner
  double growth = 0.0;                                             ///< of dark squares and marker cells, to each side [squares]
  double blur = 0.7;                                               ///< of the lens, Gaussian, the pixel's square not included [px]
  double black = 30.0, white = 208.0;                              ///< [grey levels]
  cv::Size size{640, 480};
};

/// Mean grey value over each pixel's square, before noise and rounding, CV_32F: exact to 0.01 grey levels but where dark parts overlap.
cv::Mat exactPicture(const ExactBoard& board);

/// The Cramer-Rao limit: the least covariance of the corner `squares` that any unbiased estimate can have at that noise (rounding included)
/// from the pixels nearer to it than to other corners, where the directions of its edges, blur, black and white are unknown as well. By
/// differences of pictures.
Eigen::Matrix2d cornerLimit(const ExactBoard& board, const Eigen::Vector2d& squares, double noise);

}  // namespace poecal::test
