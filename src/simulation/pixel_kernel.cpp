#include "simulation/pixel_kernel.hpp"

#include <cmath>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

namespace poecal {
namespace {

constexpr double kReach = 4.0;  // [blurs]; 6e-5 of a Gaussian lies beyond

}  // namespace

PixelKernel::PixelKernel(double blur, int parts) : parts_(parts), reach_(static_cast<int>(std::ceil(kReach * blur))) {
  const int width = reach_ * parts;
  Eigen::VectorXd gaussian = Eigen::VectorXd::Unit(2 * width + 1, width);
  if (blur > 0.0) {
    for (int d = -width; d <= width; ++d) gaussian(width + d) = std::exp(-0.5 * std::pow(d / (parts * blur), 2));
    gaussian /= gaussian.sum();
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(gaussian.size() + parts - 1);
  for (int j = 0; j < parts; ++j) weights.segment(j, gaussian.size()) += gaussian / parts;
  for (const double weight : weights) weights_.push_back(static_cast<float>(weight));
}

cv::Mat PixelKernel::gather(const cv::Mat& pixels) const {
  std::vector<float> whole;
  for (std::size_t first = 0; first < weights_.size(); first += static_cast<std::size_t>(parts_)) {
    whole.push_back(Eigen::Map<const Eigen::VectorXf>(&weights_[first], parts_).sum());
  }
  cv::Mat gathered;
  cv::sepFilter2D(pixels, gathered, CV_32F, whole, whole, cv::Point(-1, -1), 0.0, cv::BORDER_REPLICATE);
  return gathered;
}

cv::Mat PixelKernel::gatherRows(const cv::Mat& parts_picture) const {
  const auto count = static_cast<Eigen::Index>(weights_.size());
  const Eigen::Map<const Eigen::VectorXf> weights(weights_.data(), count);
  cv::Mat gathered(parts_picture.rows, parts_picture.cols / parts_ - 2 * reach_, CV_32F);
  for (int row = 0; row < gathered.rows; ++row) {
    const float* from = parts_picture.ptr<float>(row);
    float* to = gathered.ptr<float>(row);
    for (int u = 0; u < gathered.cols; ++u) to[u] = weights.dot(Eigen::Map<const Eigen::VectorXf>(from + u * parts_, count));
  }
  return gathered;
}

cv::Mat PixelKernel::gatherColumns(const cv::Mat& parts_picture) const {
  cv::Mat gathered = cv::Mat::zeros(parts_picture.rows / parts_ - 2 * reach_, parts_picture.cols, CV_32F);
  for (int v = 0; v < gathered.rows; ++v) {
    Eigen::Map<Eigen::VectorXf> to(gathered.ptr<float>(v), gathered.cols);
    for (int k = 0; k < static_cast<int>(weights_.size()); ++k) {
      to += weights_[static_cast<std::size_t>(k)] * Eigen::Map<const Eigen::VectorXf>(parts_picture.ptr<float>(v * parts_ + k), to.size());
    }
  }
  return gathered;
}

}  // namespace poecal
