#include "support/exact_tag.hpp"

#include <functional>
#include <vector>

#include <Eigen/Cholesky>

#include "support/exact_shapes.hpp"

namespace poecal::test {

cv::Mat exactPicture(const TagScene& scene) {
  const TagTexture tag = tagTexture(scene.family, scene.id);
  ExactShapes dark(scene.size);
  for (int row = 0; row < tag.texture.rows; ++row) {
    for (int col = 0; col < tag.texture.cols; ++col) {
      if (tag.texture.at<std::uint8_t>(row, col) > 127) continue;
      Eigen::Matrix2Xd cell(2, 4);
      cell << col - 0.5, col + 0.5, col + 0.5, col - 0.5,  //
          row - 0.5, row - 0.5, row + 0.5, row + 0.5;
      dark.addDark(mapPoints(cell, tag.corners, scene.corners));
    }
  }
  cv::Mat picture = dark.shares(scene.blur);
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
