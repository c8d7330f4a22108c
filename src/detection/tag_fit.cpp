#include "detection/tag_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "detection/tag_appearance.hpp"

namespace poecal {
namespace {

// Parameters: homography or corners 0..7, blur, kurtosis, growth, black and its slopes, contrast and its slopes.
constexpr int kBlur = 8, kKurtosis = 9, kGrowth = 10, kBlack = 11, kContrast = 14, kParameters = 17;
using Row = Eigen::Matrix<double, kParameters, 1>;
using Normal = Eigen::Matrix<double, kParameters + 1, kParameters + 1>;  ///< of the parameters and, last, the residual
using Light = Eigen::Matrix<double, 6, 1>;

constexpr double kEdgeReach = 2.5;      // [blurs]; what an edge tells falls as exp(-d^2), to 0.2 % here
constexpr double kUnknownReach = 3.0;   // [blurs]; 0.1 % of what lies beyond is mixed in
constexpr double kInliers = 3.0;        // [noises]
constexpr double kSmallestNoise = 0.3;  // [grey levels]; that of rounding to whole ones

/// The homography from the pattern to straight pixels, g = (g11 g12 g13 g21 g22 g23 g31 g32), g33 = 1.
class PlaneMap {
 public:
  PlaneMap(const TagCorners& uv, const TagCorners& px) {
    Eigen::Matrix<double, 8, 8> A = Eigen::Matrix<double, 8, 8>::Zero();
    for (int k = 0; k < 4; ++k) {
      const double u = uv(0, k), v = uv(1, k);
      A.row(2 * k) << u, v, 1, 0, 0, 0, -px(0, k) * u, -px(0, k) * v;
      A.row(2 * k + 1) << 0, 0, 0, u, v, 1, -px(1, k) * u, -px(1, k) * v;
    }
    const Eigen::PartialPivLU<Eigen::Matrix<double, 8, 8>> lu(A);
    const Eigen::Matrix<double, 8, 1> g = lu.solve(px.reshaped());
    px_from_uv_ << g(0), g(1), g(2), g(3), g(4), g(5), g(6), g(7), 1.0;
    uv_from_px_ = px_from_uv_.inverse();
    Eigen::Matrix<double, 8, 1> depths;
    for (int k = 0; k < 4; ++k) depths.segment<2>(2 * k).setConstant(1.0 + g(6) * uv(0, k) + g(7) * uv(1, k));
    J_g_px_ = lu.solve(Eigen::Matrix<double, 8, 8>(depths.asDiagonal()));
  }

  Eigen::Vector2d cellOf(const Eigen::Vector2d& px) const {
    const Eigen::Vector3d h = uv_from_px_.leftCols<2>() * px + uv_from_px_.col(2);
    return h.head<2>() / h.z();
  }
  /// Derivative of cellOf() at the pixel of the point `uv`.
  Eigen::Matrix2d cellsPerPixel(const Eigen::Vector2d& uv, const Eigen::Vector2d& px) const {
    return (uv_from_px_.topLeftCorner<2, 2>() - uv * uv_from_px_.row(2).head<2>()) /
           (uv_from_px_.row(2).head<2>().dot(px) + uv_from_px_(2, 2));
  }
  Eigen::Vector2d pixelOf(const Eigen::Vector2d& uv) const { return (px_from_uv_ * uv.homogeneous()).hnormalized(); }
  /// gradient^T d px / d g at a point of the pattern.
  Eigen::Matrix<double, 8, 1> alongParameters(const Eigen::Vector2d& uv, const Eigen::Vector2d& px, const Eigen::Vector2d& gradient) const {
    const double depth = px_from_uv_.row(2).head<2>().dot(uv) + 1.0;
    const double x = gradient.x() / depth, y = gradient.y() / depth;
    const double both = -x * px.x() - y * px.y();
    Eigen::Matrix<double, 8, 1> along;
    along << x * uv.x(), x * uv.y(), x, y * uv.x(), y * uv.y(), y, both * uv.x(), both * uv.y();
    return along;
  }
  const Eigen::Matrix<double, 8, 8>& parametersByCorners() const { return J_g_px_; }

 private:
  Eigen::Matrix3d px_from_uv_, uv_from_px_;
  Eigen::Matrix<double, 8, 8> J_g_px_;
};

/// A pixel, and what a step of less than a pixel leaves nearly as it is: how the cells lie about it.
struct Sight {
  Eigen::Vector2d px_straight;
  Eigen::Matrix2d J_uv_straight;
  TagView view;
  Eigen::Vector2d unit;  ///< position in the box of the tag, -1 to 1, for shading
  double grey = 0.0;
};

/// How far the residuals want to move single lines of the pattern, which a fit to noise alone leaves to chance.
class LineTally {
 public:
  explicit LineTally(int width) : pulls_(static_cast<std::size_t>(2 * (width + 1))) {}

  /// @param slope  derivatives of the grey value across the lines of both directions [1 / px].
  void add(const Eigen::Vector2d& uv, const Eigen::Vector2d& slope, double residual) {
    const std::size_t half = pulls_.size() / 2;
    for (const Eigen::Index axis : {0, 1}) {
      const auto line = static_cast<std::size_t>(std::clamp(uv(axis) + 0.5, 0.0, static_cast<double>(half - 1)));
      Pull& pull = pulls_[axis == 0 ? line : half + line];
      pull.score += slope(axis) * residual;
      pull.information += slope(axis) * slope(axis);
    }
  }

  /// Mean square of score / sqrt(information) over the lines, eight of which the corners have made fit; 1 where residuals are noise
  /// of that variance, more where they agree along lines.
  double coherence(double variance) const {
    constexpr double kFitted = 8.0;
    double sum = 0.0, lines = 0.0, most = 0.0;
    for (const Pull& pull : pulls_) most = std::max(most, pull.information);
    for (const Pull& pull : pulls_) {
      if (!(pull.information > 0.01 * most)) continue;
      sum += pull.score * pull.score / pull.information;
      lines += 1.0;
    }
    return lines > kFitted ? sum / variance / (lines - kFitted) : 1.0;
  }

 private:
  struct Pull {
    double score = 0.0, information = 0.0;
  };
  std::vector<Pull> pulls_;
};

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
    constexpr int kRoughSteps = 3, kMostSteps = 12;
    // Blur and kurtosis tell little from each other, and where the picture has neither shape they would chase each other for ever.
    constexpr int kSpreadSteps = 3;
    constexpr double kLargestChange = 0.4;  // of the kurtosis
    // The next step would be about the square of this one, in blurs: less than 1e-3 px.
    constexpr double kSettled = 0.02;  // [px]
    // Most of the way at a quarter of the price.
    if (!choosePixels(2)) return false;
    startLight();
    for (int k = 0; k < kRoughSteps; ++k) {
      if (!step(0.0)) return false;
    }
    if (!choosePixels(1)) return false;
    for (int k = 0; k < kMostSteps; ++k) {
      if (!step(k < kSpreadSteps ? kLargestChange : 0.0)) return false;
      if (last_move_ < kSettled) {
        accumulate();  // the residuals of the answer itself are judged
        return true;
      }
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
    const double variance = normal_(kParameters, kParameters) / (weights_ - kParameters);
    const double inflated = variance * std::max(1.0, lines_.coherence(variance));
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
  /// Those about the edges, given the corners and the blur so far; of every `stride`th row and column. @return whether there are enough.
  bool choosePixels(int stride) {
    constexpr std::size_t kFewest = 4 * kParameters;
    constexpr std::size_t kMost = 12000;  // beyond it noise is no longer what limits the corners
    const PlaneMap map(pattern_.corners(), state_.straight);
    const Outline outline = outlineOf(map);
    const Eigen::Vector2d centre = 0.5 * (outline.low + outline.high), half = 0.5 * (outline.high - outline.low);
    const int left = std::max(0, static_cast<int>(std::floor(outline.low.x())));
    const int right = std::min(grey_.cols - 1, static_cast<int>(std::ceil(outline.high.x())));
    const int top = std::max(0, static_cast<int>(std::floor(outline.low.y())));
    const int bottom = std::min(grey_.rows - 1, static_cast<int>(std::ceil(outline.high.y())));
    const double edge_reach = kEdgeReach * state_.spread.blur, unknown_reach = kUnknownReach * state_.spread.blur;
    TagView steepest = outline.steepest;
    pixels_.clear();
    pixels_.reserve(kMost / static_cast<std::size_t>(stride * stride));
    for (int y = top; y <= bottom; y += stride) {
      const std::uint8_t* row = grey_.ptr<std::uint8_t>(y);
      const LensPatch::Row lens_row = lens_.row(y);
      for (int x = left; x <= right; x += stride) {
        const Eigen::Vector2d px(x, y);
        const LensPatch::Straight straight = lens_row.straighten(x);
        steepest.uv = map.cellOf(straight.px);
        if (!(steepest.uv.minCoeff() >= 0.0 && steepest.uv.maxCoeff() <= pattern_.width())) continue;
        // Most pixels go here, before their own view is worked out.
        if (surroundings(pattern_, steepest, edge_reach, unknown_reach) == Surroundings::kFlat) continue;
        const Eigen::Vector2d px_straight = lens_.exactly(px, straight);
        const Eigen::Matrix2d J_uv_straight = map.cellsPerPixel(steepest.uv, px_straight);
        const TagView view(steepest.uv, J_uv_straight * straight.J_straight_px);
        if (surroundings(pattern_, view, edge_reach, unknown_reach) != Surroundings::kEdges) continue;
        pixels_.push_back({px_straight, J_uv_straight, view, (px - centre).cwiseQuotient(half), static_cast<double>(row[x])});
      }
    }
    thinOut(kMost);
    return pixels_.size() >= kFewest;
  }

  /// The box about the tag [px], and the largest slopes that a pixel in it has.
  struct Outline {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    TagView steepest{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero()};
  };
  Outline outlineOf(const PlaneMap& map) const {
    Outline outline;
    const double width = pattern_.width();
    for (const Eigen::Vector2d& uv :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(width, 0), Eigen::Vector2d(0, width), Eigen::Vector2d(width, width)}) {
      const Eigen::Vector2d px_straight = map.pixelOf(uv);
      const Eigen::Vector2d px = lens_.bend(px_straight);
      const TagView view(uv, map.cellsPerPixel(uv, px_straight) * lens_.straighten(px).J_straight_px);
      outline.low = outline.low.cwiseMin(px);
      outline.high = outline.high.cwiseMax(px);
      outline.steepest.slope = outline.steepest.slope.cwiseMax(view.slope);
    }
    return outline;
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
    accumulate();
    Row step = solve();
    const double before = state_.spread.kurtosis;
    const double kurtosis =
        std::clamp(before + std::clamp(step(kKurtosis), -largest_change, largest_change), -kLargestKurtosis, kLargestKurtosis);
    if (kurtosis != before + step(kKurtosis)) {
      // The others' best step is another one then.
      hold(kKurtosis, kurtosis - before);
      step = solve();
    }
    if (!step.allFinite()) return false;
    // A blur far off would make the linearisation leap: a third either way at most.
    const double change = std::clamp(step(kBlur), -state_.spread.blur / 3.0, state_.spread.blur / 3.0);
    state_.straight += step.head<8>().reshaped(2, 4);
    state_.spread.blur = std::max(kSmallestBlur, state_.spread.blur + change);
    state_.spread.kurtosis = kurtosis;
    state_.growth = std::clamp(state_.growth + step(kGrowth), -state_.spread.blur, state_.spread.blur);
    state_.light += step.tail<6>();
    last_move_ = std::max(step.head<8>().cwiseAbs().maxCoeff(), std::abs(step(kBlur)));
    return last_move_ < 5.0;
  }

  Row solve() const {
    return normal_.topLeftCorner<kParameters, kParameters>().ldlt().solve(normal_.block<kParameters, 1>(0, kParameters));
  }

  /// Makes the step of one parameter what is said, as an observation of far more weight than the picture's.
  void hold(int parameter, double step) {
    const double weight = 1e8 * normal_(parameter, parameter);
    normal_(parameter, parameter) += weight;
    normal_(parameter, kParameters) += weight * step;
  }

  /// The normal equations at the state, for the corners; weights by the residuals' scale of the last time.
  void accumulate() {
    constexpr int kBlock = 64;
    const PlaneMap map(pattern_.corners(), state_.straight);
    Eigen::Matrix<double, kParameters + 1, kBlock> block;
    normal_.setZero();
    residuals_.clear();
    lines_ = LineTally(pattern_.width());
    weights_ = 0.0;
    int filled = 0;
    for (const Sight& sight : pixels_) {
      const double residual = fillRow(sight, map, block.col(filled));
      residuals_.push_back(std::abs(residual));
      const double limit = kInliers * noise_;
      const double root_weight = std::abs(residual) > limit ? limit / std::abs(residual) : 1.0;
      block.col(filled) *= root_weight;
      weights_ += root_weight * root_weight;
      if (++filled == kBlock) {
        normal_.noalias() += block * block.transpose();
        filled = 0;
      }
    }
    normal_.noalias() += block.leftCols(filled) * block.leftCols(filled).transpose();
    Normal by_corners = Normal::Identity();
    by_corners.topLeftCorner<8, 8>() = map.parametersByCorners();
    normal_ = by_corners.transpose() * normal_ * by_corners;
    measureResiduals();
  }

  template <typename Column>
  double fillRow(const Sight& sight, const PlaneMap& map, Column&& column) {
    TagView view = sight.view;
    view.uv = map.cellOf(sight.px_straight);
    const Whiteness white = whiteness(pattern_, view, state_.spread, state_.growth);
    const Eigen::Vector3d shading(1.0, sight.unit.x(), sight.unit.y());
    const double black = shading.dot(state_.light.head<3>()), contrast = shading.dot(state_.light.tail<3>());
    // Where the print moves by d px, the pixel sees what lay at -d before.
    const Eigen::Vector2d gradient = -contrast * (white.J_value_uv * sight.J_uv_straight).transpose();
    column.template head<8>() = map.alongParameters(view.uv, sight.px_straight, gradient);
    column(kBlur) = contrast * white.J_value_blur;
    column(kKurtosis) = contrast * white.J_value_kurtosis;
    column(kGrowth) = contrast * white.J_value_growth;
    column.template segment<3>(kBlack) = shading;
    column.template segment<3>(kContrast) = white.value * shading;
    const double residual = sight.grey - black - contrast * white.value;
    column(kParameters) = residual;
    if (std::abs(residual) < kInliers * noise_) {
      lines_.add(view.uv, contrast * white.J_value_uv.transpose().cwiseProduct(view.slope), residual);
    }
    return residual;
  }

  void measureResiduals() {
    const auto middle = residuals_.begin() + static_cast<std::ptrdiff_t>(residuals_.size() / 2);
    std::nth_element(residuals_.begin(), middle, residuals_.end());
    constexpr double kNormalByMedian = 1.4826;
    noise_ = std::max(kSmallestNoise, kNormalByMedian * *middle);
    const auto wild = std::count_if(residuals_.begin(), residuals_.end(), [this](double r) { return r > kInliers * noise_; });
    outliers_ = static_cast<double>(wild) / static_cast<double>(residuals_.size());
  }

  const cv::Mat& grey_;
  const TagPattern& pattern_;
  const LensPatch& lens_;
  State state_;
  std::vector<Sight> pixels_;
  std::vector<double> residuals_;  ///< absolute
  LineTally lines_;
  Normal normal_;
  double noise_ = std::numeric_limits<double>::infinity();
  double outliers_ = 0.0;
  double weights_ = 0.0;
  double last_move_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Eigen::Vector4d TagFit::sigmas() const {
  Eigen::Vector4d sigmas;
  for (int k = 0; k < 4; ++k) sigmas(k) = std::sqrt(0.5 * covariance.block<2, 2>(2 * k, 2 * k).trace());
  return sigmas;
}

std::optional<TagFit> fitTag(const cv::Mat& grey, const TagPattern& pattern, const TagCorners& start, const LensPatch& lens) {
  Fit fit(grey, pattern, start, lens);
  if (!fit.run()) return std::nullopt;
  return fit.result();
}

}  // namespace poecal
