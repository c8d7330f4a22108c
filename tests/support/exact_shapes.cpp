#include "support/exact_shapes.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace poecal::test {
namespace {

constexpr int kFine = 4;  // a Gaussian of 0.5 px has two of these squares, enough for its samples to add up to it within 1e-8

}  // namespace

ExactShapes::ExactShapes(cv::Size size) : size_(size), change_(cv::Mat::zeros(size.height * kFine, size.width * kFine + 2, CV_64F)) {}

void ExactShapes::addDark(const Eigen::Matrix2Xd& outline) {
  const Eigen::Matrix2Xd fine = (kFine * (outline.array() + 0.5)).matrix();
  const Eigen::Index count = fine.cols();
  double area = 0.0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Vector2d from = fine.col(k), to = fine.col((k + 1) % count);
    area += from.x() * to.y() - from.y() * to.x();
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Vector2d from = fine.col(k), to = fine.col((k + 1) % count);
    area > 0.0 ? addSide(to, from) : addSide(from, to);
  }
}

cv::Mat ExactShapes::shares(double blur) const {
  cv::Mat areas(change_.rows, change_.cols - 2, CV_32F);
  for (int row = 0; row < areas.rows; ++row) {
    double sum = 0.0;
    for (int col = 0; col < areas.cols; ++col) areas.at<float>(row, col) = static_cast<float>(sum += change_.at<double>(row, col));
  }
  cv::GaussianBlur(areas, areas, {}, kFine * blur, kFine * blur);
  cv::Mat shares;
  cv::resize(areas, shares, size_, 0, 0, cv::INTER_AREA);
  return shares;
}

/// Adds the area to the right of the segment, downwards positive, so that a polygon's sides add up to its own area.
void ExactShapes::addSide(Eigen::Vector2d from, Eigen::Vector2d to) {
  if (from.y() == to.y()) return;
  const double sign = from.y() < to.y() ? 1.0 : -1.0;
  if (sign < 0.0) std::swap(from, to);
  const double slope = (to.x() - from.x()) / (to.y() - from.y());
  const int first = std::max(0, static_cast<int>(std::floor(from.y())));
  const int last = std::min(change_.rows - 1, static_cast<int>(std::floor(to.y())));
  for (int row = first; row <= last; ++row) {
    const double y0 = std::max(from.y(), static_cast<double>(row)), y1 = std::min(to.y(), row + 1.0);
    if (y1 > y0) addWithinRow(row, from.x() + slope * (y0 - from.y()), from.x() + slope * (y1 - from.y()), sign * (y1 - y0));
  }
}

/// A piece of a side within one row, `height` high: cut where it leaves a square; each piece fills its own square by the share to its
/// right, and those after it wholly.
void ExactShapes::addWithinRow(int row, double x0, double x1, double height) {
  if (x0 > x1) std::swap(x0, x1);
  const int left = static_cast<int>(std::floor(x0)), right = static_cast<int>(std::floor(x1));
  for (int col = left; col <= right; ++col) {
    const double a = std::max(x0, static_cast<double>(col)), b = std::min(x1, col + 1.0);
    const double piece = x1 > x0 ? height * (b - a) / (x1 - x0) : height;
    const double share = col + 1.0 - 0.5 * (a + b);
    add(row, col, piece * share);
    add(row, col + 1, piece * (1.0 - share));
  }
}
void ExactShapes::add(int row, int col, double amount) { change_.at<double>(row, std::clamp(col, 0, change_.cols - 1)) += amount; }

}  // namespace poecal::test
