#include "detection/tag_refiner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "detection/lens_patch.hpp"

namespace poecal {
namespace {

double shortestSide(const TagCorners& px) {
  double shortest = (px.col(0) - px.col(3)).norm();
  for (int k = 0; k < 3; ++k) shortest = std::min(shortest, (px.col(k + 1) - px.col(k)).norm());
  return shortest;
}

bool isInside(const cv::Mat& grey, const TagCorners& px) {
  constexpr double kMargin = 2.0;  // [px], so that each edge is seen from both sides
  return px.minCoeff() >= kMargin && px.row(0).maxCoeff() <= grey.cols - 1 - kMargin && px.row(1).maxCoeff() <= grey.rows - 1 - kMargin;
}

bool isPlausible(const TagFit& fit, const TagCorners& start, int cells_between_corners) {
  constexpr double kLargestMove = 1.0;     // [px]
  constexpr double kLeastContrast = 20.0;  // [grey levels]
  constexpr double kLargestBlur = 0.5;     // [cells]; cells melt into each other beyond
  constexpr double kLargestNoise = 0.06;   // of the contrast
  constexpr double kMostOutliers = 0.2;
  return (fit.px - start).colwise().norm().maxCoeff<Eigen::PropagateNaN>() <= kLargestMove && fit.contrast >= kLeastContrast &&
         fit.spread.blur <= kLargestBlur * shortestSide(fit.px) / cells_between_corners && fit.noise <= kLargestNoise * fit.contrast &&
         fit.outliers <= kMostOutliers;
}

}  // namespace

double unrefinedSigma(const TagCorners& px) {
  constexpr double kSigma = 0.055;     // [px]
  constexpr double kSmallSide = 40.0;  // [px]
  const double shortfall = std::max(1.0, kSmallSide / shortestSide(px));
  return kSigma * shortfall * shortfall;
}

TagRefiner::TagRefiner(std::string family, bool bare_corners, std::optional<Camera> camera, int border_bits)
    : family_(std::move(family)), bare_corners_(bare_corners), border_bits_(border_bits), camera_(std::move(camera)) {}

std::optional<TagFit> TagRefiner::refine(const cv::Mat& grey, int id, const TagCorners& px) {
  if (!isInside(grey, px)) return std::nullopt;
  const Eigen::Vector2d low = px.rowwise().minCoeff(), high = px.rowwise().maxCoeff();
  std::optional<LensPatch> lens = LensPatch();
  if (camera_) {
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.15 * (high - low).maxCoeff());
    lens = LensPatch::of(*camera_, low - margin, high + margin);
    if (!lens) return std::nullopt;
  }
  const TagPattern& pattern = patternOf(id);
  std::optional<TagFit> fit = fitTag(grey, pattern, px, *lens);
  const int cells = static_cast<int>(std::lround(pattern.corners()(0, 1) - pattern.corners()(0, 0)));
  if (!fit || !isPlausible(*fit, px, cells)) return std::nullopt;
  if (!(fit->sigmas().maxCoeff<Eigen::PropagateNaN>() <= unrefinedSigma(px))) return std::nullopt;
  return fit;
}

const TagPattern& TagRefiner::patternOf(int id) {
  const auto known = patterns_.find(id);
  if (known != patterns_.end()) return known->second;
  return patterns_.emplace(id, TagPattern(family_, id, bare_corners_, border_bits_)).first->second;
}

}  // namespace poecal
