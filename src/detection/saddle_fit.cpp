#include "detection/saddle_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "detection/gram_sum.hpp"

namespace poecal {
namespace {

// Parameters: shift of the pattern along u and v, tilt of either line, blur, kurtosis, growth, black and its slopes, contrast and its
// slopes; then the residual and one column that is not used.
constexpr int kBlur = 4, kKurtosis = 5, kGrowth = 6, kBlack = 7, kContrast = 10, kParameters = 13;
using Step = Eigen::Matrix<double, kParameters, 1>;
using Rows = GramSum<kParameters + 1, 7>;
using Light = Eigen::Matrix<double, 6, 1>;

constexpr double kEdgeReach = 2.5;      // [blurs]
constexpr double kHiddenReach = 3.0;    // [blurs]
constexpr double kInliers = 3.0;        // [noises]
constexpr double kSmallestNoise = 0.3;  // [grey levels]; that of rounding to whole ones

struct SaddlePixel {
  TagView view;
  Eigen::Vector2d unit = Eigen::Vector2d::Zero();  ///< position about the corner, -1 to 1, for shading
  double grey = 0.0;
};

class Fit {
 public:
  Fit(const cv::Mat& grey, const SaddleCells& cells, const SaddleView& view, const PointSpread& spread)
      : grey_(grey), cells_(cells), pattern_(cells.pattern(view.dark)), view_(view), spread_(spread) {}

  bool run(int stride) {
    constexpr int kMostSteps = 12;
    constexpr double kSettled = 0.1;  // what the noise leaves open is worth 13, one for each parameter
    if (!choosePixels(stride)) return false;
    startLight();
    for (int k = 0; k < kMostSteps; ++k) {
      if (!step()) return false;
      if (last_gain_ < kSettled) return true;
    }
    return false;
  }

  SaddleFit result() const {
    SaddleFit fit;
    // Where the moved pattern's middle came to be: what lay there before is the corner.
    Eigen::Matrix2d A;
    A << 1.0, -tilt_.x(), -tilt_.y(), 1.0;
    const Eigen::Matrix2d J_cells_m = A.inverse();
    const Eigen::Vector2d squares = cells_.cell() * (J_cells_m * shift_);
    fit.px = view_.pixelOf(squares);
    const Eigen::Matrix<double, kParameters, kParameters> inverse =
        normal_.topLeftCorner<kParameters, kParameters>().ldlt().solve(Eigen::Matrix<double, kParameters, kParameters>::Identity());
    const Eigen::Matrix2d J_px_m = cells_.cell() * view_.pixelsPerSquare(squares) * J_cells_m;
    fit.covariance = variance() * J_px_m * inverse.topLeftCorner<2, 2>() * J_px_m.transpose();
    fit.spread = spread_;
    fit.growth = growth_;
    fit.contrast = light_(3);
    fit.noise = noise_;
    fit.outliers = outliers_;
    return fit;
  }

 private:
  double variance() const { return normal_(kParameters, kParameters) / (weights_ - kParameters); }

  bool choosePixels(int stride) {
    constexpr std::size_t kFewest = 3 * kParameters;
    constexpr double kReach = 0.5;  // [squares]
    constexpr int kFlatStride = 2;
    Eigen::Vector2d low = view_.px, high = view_.px;
    for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1), Eigen::Vector2d(-1, 1), Eigen::Vector2d(1, 1)}) {
      const Eigen::Vector2d px = view_.pixelOf(kReach * corner);
      low = low.cwiseMin(px);
      high = high.cwiseMax(px);
    }
    const Eigen::Vector2d half = 0.5 * (high - low);
    const int left = std::max(0, static_cast<int>(std::ceil(low.x()))), right = std::min(grey_.cols - 1, static_cast<int>(high.x()));
    const int top = std::max(0, static_cast<int>(std::ceil(low.y()))), bottom = std::min(grey_.rows - 1, static_cast<int>(high.y()));
    const Eigen::Matrix2d J_squares_px = view_.J_px_squares.inverse();
    // The slopes change by less than half of it over the patch.
    const Eigen::Vector2d farthest = 1.5 * kEdgeReach * spread_.blur * J_squares_px.rowwise().norm();
    pixels_.clear();
    for (int y = top; y <= bottom; y += stride) {
      const std::uint8_t* row = grey_.ptr<std::uint8_t>(y);
      for (int x = left; x <= right; x += stride) {
        const Eigen::Vector2d px(x, y), rough = J_squares_px * (px - view_.px);
        const bool thin = x % kFlatStride == 0 && y % kFlatStride == 0;
        if (!thin && cells_.toLine(rough.x()) > farthest.x() && cells_.toLine(rough.y()) > farthest.y()) continue;
        const Eigen::Vector2d squares = view_.squaresAt(px);
        if (!(squares.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kReach)) continue;
        const Eigen::Matrix2d J = view_.pixelsPerSquare(squares).inverse();
        const Eigen::Vector2d blurs = spread_.blur * J.rowwise().norm();
        if (cells_.isHidden(squares, kHiddenReach * blurs, view_.dark)) continue;
        const TagView view((squares / cells_.cell()).array() + cells_.middle(), J / cells_.cell());
        const Eigen::Vector2d near = kEdgeReach * spread_.blur * view.slope;
        if (!thin && pattern_.isUniform(view.uv - near, view.uv + near)) continue;
        pixels_.push_back({view, (px - view_.px).cwiseQuotient(half), static_cast<double>(row[x])});
      }
    }
    return pixels_.size() >= kFewest;
  }

  void startLight() {
    accumulate();
    const Eigen::Matrix<double, 6, 6> A = normal_.block<6, 6>(kBlack, kBlack);
    light_ = A.ldlt().solve(normal_.block<6, 1>(kBlack, kParameters));
    noise_ = std::numeric_limits<double>::infinity();  // the residuals so far were those of no light at all
  }

  bool step() {
    constexpr double kSmallestBlur = 0.3;     // [px]; the pixel's own square
    constexpr double kLargestKurtosis = 1.0;  // what a halo of some hundredths of the light has
    accumulate();
    addPriors();
    const Step step = normal_.topLeftCorner<kParameters, kParameters>().ldlt().solve(normal_.block<kParameters, 1>(0, kParameters));
    if (!step.allFinite()) return false;
    const double change = std::clamp(step(kBlur), -spread_.blur / 3.0, spread_.blur / 3.0);
    shift_ += step.head<2>();
    tilt_ += step.segment<2>(2);
    spread_.blur = std::max(kSmallestBlur, spread_.blur + change);
    spread_.kurtosis = std::clamp(spread_.kurtosis + step(kKurtosis), -kLargestKurtosis, kLargestKurtosis);
    growth_ = std::clamp(growth_ + step(kGrowth), -spread_.blur, spread_.blur);
    light_ += step.tail<6>();
    last_gain_ = step.dot(normal_.block<kParameters, 1>(0, kParameters)) / variance();
    constexpr double kLargestMove = 0.5;  // [squares]
    return cells_.cell() * shift_.cwiseAbs().maxCoeff() < kLargestMove && tilt_.cwiseAbs().maxCoeff() < kLargestMove;
  }

  /// Few pixels do not tell the shape of the spread; nothing depends on it but how well the model fits.
  void addPriors() {
    constexpr double kKurtosisDeviation = 0.3, kGrowthDeviation = 0.5;  // [-], [px]
    const auto pull = [this](int parameter, double towards, double deviation) {
      const double weight = variance() / (deviation * deviation);
      normal_(parameter, parameter) += weight;
      normal_(parameter, kParameters) += weight * towards;
    };
    pull(kKurtosis, -spread_.kurtosis, kKurtosisDeviation);
    pull(kGrowth, -growth_, kGrowthDeviation);
  }

  void accumulate() {
    Rows rows;
    residuals_.clear();
    weights_ = 0.0;
    const double limit = kInliers * noise_;
    for (const SaddlePixel& pixel : pixels_) {
      auto row = rows.next();
      const double residual = std::abs(fillRow(pixel, row));
      residuals_.push_back(residual);
      if (residual > limit) {
        row *= limit / residual;
        weights_ += (limit / residual) * (limit / residual);
      } else {
        weights_ += 1.0;
      }
    }
    normal_ = rows.take();
    measureResiduals();
  }

  template <typename RowVector>
  double fillRow(const SaddlePixel& pixel, RowVector& row) const {
    TagView view = pixel.view;
    const double u = view.uv.x() - cells_.middle(), v = view.uv.y() - cells_.middle();
    view.uv -= shift_ + Eigen::Vector2d(tilt_.x() * v, tilt_.y() * u);
    const Whiteness white = whiteness(pattern_, view, spread_, growth_);
    const Eigen::Vector3d shading(1.0, pixel.unit.x(), pixel.unit.y());
    const double black = shading.dot(light_.head<3>()), contrast = shading.dot(light_.tail<3>());
    const Eigen::RowVector2d gradient = -contrast * white.J_value_uv;
    row.template head<4>() << gradient(0), gradient(1), gradient(0) * v, gradient(1) * u;
    row(kBlur) = contrast * white.J_value_blur;
    row(kKurtosis) = contrast * white.J_value_kurtosis;
    row(kGrowth) = contrast * white.J_value_growth;
    row.template segment<3>(kBlack) = shading;
    row.template segment<3>(kContrast) = white.value * shading;
    const double residual = pixel.grey - black - contrast * white.value;
    row(kParameters) = residual;
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
  const SaddleCells& cells_;
  const TagPattern& pattern_;
  SaddleView view_;
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero(), tilt_ = Eigen::Vector2d::Zero();
  PointSpread spread_;
  double growth_ = 0.0;
  Light light_ = Light::Zero();
  std::vector<SaddlePixel> pixels_;
  std::vector<double> residuals_;  ///< absolute
  Rows::Matrix normal_ = Rows::Matrix::Zero();
  double noise_ = std::numeric_limits<double>::infinity();
  double outliers_ = 0.0;
  double weights_ = 0.0;
  double last_gain_ = std::numeric_limits<double>::infinity();  ///< of the last step, in variances of the noise
};

}  // namespace

Eigen::Vector2d SaddleView::pixelOf(const Eigen::Vector2d& squares) const {
  const double u = squares.x(), v = squares.y();
  return px + J_px_squares * squares + uu * (u * u) + uv * (u * v) + vv * (v * v);
}

Eigen::Matrix2d SaddleView::pixelsPerSquare(const Eigen::Vector2d& squares) const {
  Eigen::Matrix2d J = J_px_squares;
  J.col(0) += 2.0 * squares.x() * uu + squares.y() * uv;
  J.col(1) += 2.0 * squares.y() * vv + squares.x() * uv;
  return J;
}

Eigen::Vector2d SaddleView::squaresAt(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d squares = J_px_squares.inverse() * (pixel - px);
  for (int k = 0; k < 2; ++k) squares += pixelsPerSquare(squares).inverse() * (pixel - pixelOf(squares));
  return squares;
}

double SaddleFit::sigma() const { return std::sqrt(0.5 * covariance.trace()); }

std::optional<SaddleFit> fitSaddle(const cv::Mat& grey, const SaddleCells& cells, const SaddleView& view, const PointSpread& spread,
                                   int stride) {
  Fit fit(grey, cells, view, spread);
  if (!fit.run(stride)) return std::nullopt;
  return fit.result();
}

}  // namespace poecal
