#include "detection/tag_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "detection/edge_pixels.hpp"
#include "detection/gram_sum.hpp"
#include "detection/line_tally.hpp"
#include "detection/lit_pixel.hpp"
#include "detection/residual_noise.hpp"
#include "detection/tag_appearance.hpp"

namespace poecal {
namespace {

// Parameters: motion of the pattern or corners 0..7, blur, kurtosis, growth, black and its slopes, contrast and its slopes; then the
// residual.
constexpr int kBlur = 8, kKurtosis = 9, kGrowth = 10, kBlack = 11, kParameters = kBlur + kLitParameters;
using Step = Eigen::Matrix<double, kParameters, 1>;
using Rows = GramSum<kParameters + 1, 6>;

struct State {
  TagCorners straight;  ///< corners behind the lens
  PointSpread spread;
  double growth = 0.0;
  Light light = Light::Zero();
};

class Fit {
 public:
  Fit(const cv::Mat& grey, const TagPattern& pattern, const TagCorners& start, const LensPatch& lens)
      : grey_(grey), pattern_(pattern), lens_(lens), lines_(pattern.width()) {
    for (int k = 0; k < 4; ++k) state_.straight.col(k) = lens.straightenExactly(start.col(k)).px;
  }

  bool run() {
    constexpr int kRoughSteps = 2, kMostSteps = 12;
    // Blur and kurtosis tell little from each other, and where the picture has neither shape they would chase each other for ever.
    constexpr int kSpreadSteps = 3;
    constexpr double kLargestChange = 0.4;  // of the kurtosis
    // What the noise leaves open is worth 17, one for each parameter; what this step leaves is its square in blurs.
    constexpr double kSettled = 0.1;
    // Most of the way at a fraction of the price. Every so many rows and columns of an upright tag may all miss its edges.
    const State start = state_;
    if (!choosePixels(roughStride())) return false;
    startLight();
    bool is_nearer = true;
    for (int k = 0; k < kRoughSteps && is_nearer; ++k) is_nearer = step(0.0);
    if (!is_nearer) state_ = start;
    if (!choosePixels(1)) return false;
    if (!is_nearer) startLight();
    for (int k = 0; k < kMostSteps; ++k) {
      if (!step(k < kSpreadSteps ? kLargestChange : 0.0)) return false;
      if (last_gain_ < kSettled) return true;
    }
    return false;
  }

  TagFit result() const {
    TagFit fit;
    Eigen::Matrix<double, 8, 8> J_px_straight = Eigen::Matrix<double, 8, 8>::Zero();
    for (int k = 0; k < 4; ++k) {
      fit.px.col(k) = lens_.bend(state_.straight.col(k));
      J_px_straight.block<2, 2>(2 * k, 2 * k) = lens_.straighten(fit.px.col(k)).J_straight_px.inverse();
    }
    const Eigen::Matrix<double, kParameters, kParameters> inverse =
        normal_.topLeftCorner<kParameters, kParameters>().ldlt().solve(Eigen::Matrix<double, kParameters, kParameters>::Identity());
    // What the model lacks shows in the residuals; where it pulls whole lines, pixels do not average it away.
    const double inflated = variance() * std::max(1.0, lines_.coherence(variance()));
    fit.covariance = inflated * J_px_straight * inverse.topLeftCorner<8, 8>() * J_px_straight.transpose();
    fit.spread = state_.spread;
    fit.growth = state_.growth;
    fit.contrast = state_.light(3);
    fit.noise = noise_;
    fit.outliers = outliers_;
    fit.pixels = static_cast<int>(pixels_.size());
    return fit;
  }

 private:
  double variance() const { return normal_(kParameters, kParameters) / (weights_ - kParameters); }

  /// Such that some hundred pixels are left of a tag of any size.
  int roughStride() const {
    constexpr double kSidePerPixel = 60.0;  // [px]
    const double side = (state_.straight.col(2) - state_.straight.col(0)).norm() / std::numbers::sqrt2;
    return std::max(2, static_cast<int>(side / kSidePerPixel));
  }

  /// Those about the edges, given the corners and the blur so far; of every `stride`th row and column. @return whether there are enough.
  bool choosePixels(int stride) {
    constexpr std::size_t kFewest = 4 * kParameters;
    constexpr std::size_t kMost = 12000;  // beyond it noise is no longer what limits the corners
    pixels_ = edgePixels(grey_, pattern_, lens_, PlaneMap(pattern_.corners(), state_.straight), state_.spread.blur, stride);
    thinOut(kMost);
    return pixels_.size() >= kFewest;
  }

  void thinOut(std::size_t most) {
    const std::size_t stride = (pixels_.size() + most - 1) / most;
    if (stride <= 1) return;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < pixels_.size(); k += stride) pixels_[kept++] = pixels_[k];
    pixels_.erase(pixels_.begin() + static_cast<std::ptrdiff_t>(kept), pixels_.end());
  }

  /// Light enters linearly, so one solution for it alone is where it starts.
  void startLight() {
    accumulate();
    const Eigen::Matrix<double, 6, 6> A = normal_.block<6, 6>(kBlack, kBlack);
    state_.light = A.ldlt().solve(normal_.block<6, 1>(kBlack, kParameters));
    noise_ = std::numeric_limits<double>::infinity();  // the residuals so far were those of no light at all
  }

  /// One step. @param largest_change  of the kurtosis; 0 holds it.
  bool step(double largest_change) {
    constexpr double kSmallestBlur = 0.3;     // [px]; the pixel's own square
    constexpr double kLargestKurtosis = 1.0;  // what a halo of some hundredths of the light has
    constexpr double kLargestMove = 5.0;      // [px]
    accumulate();
    Rows::Matrix normal = normal_;
    Step step = solve(normal);
    const double before = state_.spread.kurtosis;
    const double kurtosis =
        std::clamp(before + std::clamp(step(kKurtosis), -largest_change, largest_change), -kLargestKurtosis, kLargestKurtosis);
    if (kurtosis != before + step(kKurtosis)) {
      // The others' best step is another one then.
      hold(kKurtosis, kurtosis - before, normal);
      step = solve(normal);
    }
    if (!step.allFinite()) return false;
    // A blur far off would make the linearisation leap: a third either way at most.
    const double change = std::clamp(step(kBlur), -state_.spread.blur / 3.0, state_.spread.blur / 3.0);
    // Of what is sharper than pixels are, a smaller blur is wished for at every step and never had.
    const double sharpest = kSmallestBlur - state_.spread.blur;
    if (change < sharpest) {
      hold(kBlur, sharpest, normal);
      step = solve(normal);
    }
    state_.straight += step.head<8>().reshaped(2, 4);
    state_.spread.blur += std::max(change, sharpest);
    state_.spread.kurtosis = kurtosis;
    state_.growth = std::clamp(state_.growth + step(kGrowth), -state_.spread.blur, state_.spread.blur);
    state_.light += step.tail<6>();
    // Rounding alone leaves the least noise: in a picture without any other a fit would never come to rest.
    const double least = std::max(variance(), kSmallestNoise * kSmallestNoise);
    last_gain_ = step.dot(normal_.block<kParameters, 1>(0, kParameters)) / least;
    return step.head<8>().cwiseAbs().maxCoeff() < kLargestMove;
  }

  static Step solve(const Rows::Matrix& normal) {
    return normal.topLeftCorner<kParameters, kParameters>().ldlt().solve(normal.block<kParameters, 1>(0, kParameters));
  }

  /// Has the step of one parameter as said, as by an observation of far more weight than the picture's.
  static void hold(int parameter, double step, Rows::Matrix& normal) {
    const double weight = 1e8 * normal(parameter, parameter);
    normal(parameter, parameter) += weight;
    normal(parameter, kParameters) += weight * step;
  }

  /// The normal equations at the state, for the corners; weights by the residuals' scale of the last time.
  void accumulate() {
    const PlaneMap map(pattern_.corners(), state_.straight);
    Rows rows;
    residuals_.clear();
    lines_ = LineTally(pattern_.width());
    weights_ = 0.0;
    const double limit = kInliers * noise_;
    for (const EdgePixel& pixel : pixels_) {
      auto row = rows.next();
      const double residual = std::abs(fillRow(pixel, map, row));
      residuals_.push_back(residual);
      if (residual > limit) {
        row *= limit / residual;
        weights_ += (limit / residual) * (limit / residual);
      } else {
        weights_ += 1.0;
      }
    }
    normal_ = rows.take();
    Rows::Matrix J_m_corners = Rows::Matrix::Identity();
    J_m_corners.topLeftCorner<8, 8>() = map.cornersByMotion().inverse();
    normal_ = J_m_corners.transpose() * normal_ * J_m_corners;
    measureResiduals();
  }

  template <typename RowVector>
  double fillRow(const EdgePixel& pixel, const PlaneMap& map, RowVector& row) {
    TagView view = pixel.view;
    view.uv = map.cellOf(pixel.px_straight);
    const Whiteness white = whiteness(pattern_, view, state_.spread, state_.growth);
    const LitPixel lit = fillLit<kBlur>(pixel, white, state_.light, row);
    // Where the pattern moves by f, the pixel sees what lay at -f before.
    const Eigen::RowVector2d gradient = -lit.contrast * white.J_value_uv;
    const double u = view.uv.x(), v = view.uv.y(), both = gradient.dot(view.uv);
    row.template head<8>() << gradient(0), gradient(0) * u, gradient(0) * v, gradient(1), gradient(1) * u, gradient(1) * v, both * u,
        both * v;
    if (std::abs(lit.residual) < kInliers * noise_) {
      lines_.add(view.uv, lit.contrast * white.J_value_uv.transpose().cwiseProduct(view.slope), lit.residual);
    }
    return lit.residual;
  }

  void measureResiduals() {
    const ResidualNoise measured = residualNoise(residuals_);
    noise_ = measured.noise;
    outliers_ = measured.outliers;
  }

  const cv::Mat& grey_;
  const TagPattern& pattern_;
  const LensPatch& lens_;
  State state_;
  std::vector<EdgePixel> pixels_;
  std::vector<double> residuals_;  ///< absolute
  LineTally lines_;
  Rows::Matrix normal_ = Rows::Matrix::Zero();
  double noise_ = std::numeric_limits<double>::infinity();
  double outliers_ = 0.0;
  double weights_ = 0.0;
  double last_gain_ = std::numeric_limits<double>::infinity();  ///< of the last step, in variances of the noise
};

}  // namespace

Eigen::Vector4d TagFit::sigmas() const {
  Eigen::Vector4d sigmas;
  for (int k = 0; k < 4; ++k) sigmas(k) = std::sqrt(0.5 * covariance.block<2, 2>(2 * k, 2 * k).trace());
  return sigmas;
}

PictureLook TagFit::look() const {
  constexpr double kSquare = 1.0 / 12.0;  // variance of what is even over one pixel, or one grey level
  const auto without = [](double whole) { return std::sqrt(std::max(0.0, whole * whole - kSquare)); };
  return {without(spread.blur), without(noise), growth};
}

std::optional<TagFit> fitTag(const cv::Mat& grey, const TagPattern& pattern, const TagCorners& start, const LensPatch& lens) {
  Fit fit(grey, pattern, start, lens);
  if (!fit.run()) return std::nullopt;
  return fit.result();
}

}  // namespace poecal
