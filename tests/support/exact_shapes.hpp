// Areas that polygons cover of the pixels of a picture: what exact pictures are made of.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace poecal::test {

/// A picture of dark polygons, blurred by a Gaussian and then averaged over each pixel's square.
class ExactShapes {
 public:
  explicit ExactShapes(cv::Size size);

  /// @param outline  in OpenCV's pixels, either way round.
  void addDark(const Eigen::Matrix2Xd& outline);
  /// CV_32F: how much of each pixel is dark. @param blur  [px]
  cv::Mat shares(double blur) const;

 private:
  void addSide(Eigen::Vector2d from, Eigen::Vector2d to);
  void addWithinRow(int row, double x0, double x1, double height);
  void add(int row, int col, double amount);

  cv::Size size_;
  cv::Mat change_;
};

}  // namespace poecal::test
