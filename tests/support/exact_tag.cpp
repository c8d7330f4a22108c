#include "support/exact_tag.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

namespace poecal::test {
namespace {

constexpr int kFine = 4;  // a Gaussian of 0.5 px has two of these squares, enough for its samples to add up to it within 1e-8

/// Area that polygons cover of each square of a grid, square (x, y) from x to x + 1.
class Coverage {
 public:
  explicit Coverage(cv::Size size) : change_(cv::Mat::zeros(size.height, size.width + 2, CV_64F)) {}

  /// Adds the area to the right of the segment, downwards positive, so that a polygon's sides add up to its own area.
  void addSide(Eigen::Vector2d from, Eigen::Vector2d to) {
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

  cv::Mat areas() const {
    cv::Mat areas(change_.rows, change_.cols - 2, CV_32F);
    for (int row = 0; row < areas.rows; ++row) {
      double sum = 0.0;
      for (int col = 0; col < areas.cols; ++col) areas.at<float>(row, col) = static_cast<float>(sum += change_.at<double>(row, col));
    }
    return areas;
  }

 private:
  /// A piece of a side within one row, `height` high: cut where it leaves a square; each piece fills its own square by the share to its
  /// right, and those after it wholly.
  void addWithinRow(int row, double x0, double x1, double height) {
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
  void add(int row, int col, double amount) { change_.at<double>(row, std::clamp(col, 0, change_.cols - 1)) += amount; }

  cv::Mat change_;
};

}  // namespace

cv::Mat exactPicture(const TagScene& scene) {
  const TagTexture tag = tagTexture(scene.family, scene.id);
  const Quad fine = (kFine * (scene.corners.array() + 0.5)).matrix();
  Coverage dark(scene.size * kFine);
  for (int row = 0; row < tag.texture.rows; ++row) {
    for (int col = 0; col < tag.texture.cols; ++col) {
      if (tag.texture.at<std::uint8_t>(row, col) > 127) continue;
      Eigen::Matrix2Xd cell(2, 4);
      cell << col - 0.5, col + 0.5, col + 0.5, col - 0.5,  //
          row - 0.5, row - 0.5, row + 0.5, row + 0.5;
      const Eigen::Matrix2Xd px = mapPoints(cell, tag.corners, fine);
      for (Eigen::Index k = 0; k < 4; ++k) dark.addSide(px.col((k + 1) % 4), px.col(k));
    }
  }
  cv::Mat share = dark.areas();
  cv::GaussianBlur(share, share, {}, kFine * scene.blur, kFine * scene.blur);
  cv::Mat picture;
  cv::resize(share, picture, scene.size, 0, 0, cv::INTER_AREA);
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      const double light = 1.0 + scene.shading.x() * (static_cast<double>(col) / picture.cols - 0.5) +
                           scene.shading.y() * (static_cast<double>(row) / picture.rows - 0.5);
      float& grey = picture.at<float>(row, col);
      grey = static_cast<float>(light * (scene.white + grey * (scene.black - scene.white)));
    }
  }
  return picture;
}

cv::Mat withNoise(const cv::Mat& exact, Rng& rng, double noise) {
  cv::Mat values = exact.clone();
  for (int row = 0; row < values.rows; ++row) {
    for (int col = 0; col < values.cols; ++col) values.at<float>(row, col) += static_cast<float>(noise * rng.normal());
  }
  cv::Mat picture;
  values.convertTo(picture, CV_8U);
  return picture;
}

Eigen::Matrix<double, 8, 8> cornerLimit(const TagScene& scene, double noise) {
  constexpr double kRounding = 1.0 / 12.0;  // variance
  const auto slope = [&scene](double step, const std::function<void(TagScene&, double)>& change) {
    TagScene low = scene, high = scene;
    change(low, -step);
    change(high, step);
    return cv::Mat((exactPicture(high) - exactPicture(low)) / (2.0 * step));
  };
  std::vector<cv::Mat> slopes;
  for (int k = 0; k < 8; ++k) slopes.push_back(slope(0.05, [k](TagScene& s, double step) { s.corners(k % 2, k / 2) += step; }));
  slopes.push_back(slope(0.02, [](TagScene& s, double step) { s.blur += step; }));
  slopes.push_back(slope(1.0, [](TagScene& s, double step) { s.black += step; }));
  slopes.push_back(slope(1.0, [](TagScene& s, double step) { s.white += step; }));
  const auto count = static_cast<Eigen::Index>(slopes.size());
  Eigen::MatrixXd information(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      information(i, j) = slopes[static_cast<std::size_t>(i)].dot(slopes[static_cast<std::size_t>(j)]) / (noise * noise + kRounding);
    }
  }
  return information.ldlt().solve(Eigen::MatrixXd::Identity(count, count)).topLeftCorner<8, 8>();
}

}  // namespace poecal::test
