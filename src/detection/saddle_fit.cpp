#include "detection/saddle_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "detection/gram_sum.hpp"
#include "detection/lit_pixel.hpp"
#include "detection/residual_noise.hpp"

namespace poecal {
namespace {

// Parameters: shift of the pattern along u and v, tilt of either line, blur, kurtosis, growth, black and its slopes, contrast and its
// slopes; then the residual, and two columns of zeros that fill the last tile.
constexpr int kBlur = 4, kKurtosis = 5, kGrowth = 6, kBlack = 7, kParameters = kBlur + kLitParameters, kColumns = 16;
using Step = Eigen::Matrix<double, kParameters, 1>;
using Rows = GramSum<kColumns, 4>;

constexpr double kEdgeReach = 2.5;    // [blurs]; what an edge tells falls as exp(-d^2), to 0.2 % here
constexpr double kHiddenReach = 3.0;  // [blurs]; 0.1 % of what lies beyond is mixed in
constexpr double kReach = 0.5;        // [squares]

struct SaddlePixel {
  TagView view;
  Eigen::Vector2d unit = Eigen::Vector2d::Zero();  ///< position about the corner, -1 to 1, for shading
  double grey = 0.0;
};

/// How far the residuals want to move pieces of the four edges that meet in a corner, which a fit to noise alone leaves to chance.
class EdgeTally {
 public:
  /// @param squares  from the corner. @param slope  derivatives of the grey value across the lines of both directions [1 / px].
  /// @param row  derivatives by the parameters, then the residual.
  template <typename RowVector>
  void add(const Eigen::Vector2d& squares, const Eigen::Vector2d& slope, const RowVector& row) {
    const Eigen::Index axis = std::abs(slope(0)) > std::abs(slope(1)) ? 0 : 1;
    if (slope(axis) == 0.0) return;
    const double along = (squares(1 - axis) + kReach) * (kPieces / (2.0 * kReach));
    const auto piece = static_cast<std::size_t>(std::clamp(along, 0.0, kPieces - 1.0));
    Pull& pull = pulls_[static_cast<std::size_t>(axis) * kPieces + piece];
    pull.scores += slope(axis) * row.template head<kParameters + 1>();
    pull.information += slope(axis) * slope(axis);
  }

  /// Mean square of score / sqrt(information) over the pieces: 1 where residuals are noise of that variance.
  /// @param step  of the parameters, which the residuals that are meant lie behind.
  double coherence(double variance, const Step& step) const {
    constexpr double kFitted = 5.0;  // the corner, both directions, growth
    double sum = 0.0, pieces = 0.0, most = 0.0;
    for (const Pull& pull : pulls_) most = std::max(most, pull.information);
    for (const Pull& pull : pulls_) {
      if (!(pull.information > 0.1 * most)) continue;
      const double score = pull.scores(kParameters) - pull.scores.head<kParameters>().dot(step);
      sum += score * score / pull.information;
      pieces += 1.0;
    }
    return pieces > kFitted ? sum / variance / (pieces - kFitted) : 1.0;
  }

 private:
  static constexpr std::size_t kPieces = 8;  // of each line
  struct Pull {
    Eigen::Matrix<double, kParameters + 1, 1> scores = Eigen::Matrix<double, kParameters + 1, 1>::Zero();
    double information = 0.0;
  };
  std::array<Pull, 2 * kPieces> pulls_{};
};

class Fit {
 public:
  Fit(const cv::Mat& grey, const SaddleCells& cells, const SaddleView& view, const SaddleLook& start)
      : grey_(grey), cells_(cells), pattern_(cells.pattern(view.dark)), view_(view), look_(start) {}

  bool run(int stride) {
    constexpr int kMostSteps = 15;
    constexpr double kSettled = 0.1;  // of the corner's sigma
    if (!choosePixels(stride)) return false;
    if (look_.noise == 0.0) startLight();
    for (int k = 0; k < kMostSteps; ++k) {
      const Eigen::Vector2d before = shift_;
      if (!step()) return false;
      const double moved = (cells_.cell() * view_.J_px_squares * (shift_ - before)).norm();
      // What a step leaves is its square in blurs; or, where weights change as it goes, a part of it.
      if (moved < kSettled * sigma() || (k >= quick_steps_ && moved * moved < kSettled * sigma() * look_.spread.blur)) return true;
    }
    return false;
  }

  SaddleFit result() {
    SaddleFit fit;
    const Eigen::Matrix2d J_cells_m = cellsByShift();
    const Eigen::Vector2d squares = cells_.cell() * (J_cells_m * shift_);
    fit.px = view_.pixelOf(squares);
    const Eigen::Matrix2d J_px_m = cells_.cell() * view_.pixelsPerSquare(squares) * J_cells_m;
    // Noise that agrees by chance does so by less.
    constexpr double kByChance = 2.0;
    const double coherence = tally_.coherence(variance_, last_step_);
    fit.covariance = (coherence > kByChance ? coherence : 1.0) * J_px_m * shift_covariance_ * J_px_m.transpose();
    fit.look = look_;
    fit.outliers = outliers_;
    return fit;
  }

 private:
  /// Where the moved pattern's middle came to be, what lay there before is the corner; tilts bring it elsewhere than the shift says.
  Eigen::Matrix2d cellsByShift() const {
    Eigen::Matrix2d A;
    A << 1.0, -tilt_.x(), -tilt_.y(), 1.0;
    return A.inverse();
  }
  double sigma() const {
    const Eigen::Matrix2d J = cells_.cell() * view_.J_px_squares;
    return std::sqrt(0.5 * (J * shift_covariance_ * J.transpose()).trace());
  }

  bool choosePixels(int stride) {
    constexpr std::size_t kFewest = 3 * kParameters;
    constexpr double kFlatPerSquare = 28.0;
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
    const double blur = look_.spread.blur;
    // The slopes change by less than half of it over the patch.
    const Eigen::Vector2d farthest = 1.5 * kEdgeReach * blur * J_squares_px.rowwise().norm();
    const int flat_stride = stride * std::max(1, static_cast<int>(half.maxCoeff() * 2.0 / kFlatPerSquare));
    pixels_.clear();
    for (int y = top; y <= bottom; y += stride) {
      const std::uint8_t* row = grey_.ptr<std::uint8_t>(y);
      for (int x = left; x <= right; x += stride) {
        const Eigen::Vector2d px(x, y), rough = J_squares_px * (px - view_.px);
        const bool flat = (x - left) % flat_stride == 0 && (y - top) % flat_stride == 0;
        if (!flat && cells_.toLine(rough.x()) > farthest.x() && cells_.toLine(rough.y()) > farthest.y()) continue;
        const Eigen::Vector2d squares = view_.squaresAt(px, J_squares_px);
        if (!(squares.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kReach)) continue;
        const Eigen::Matrix2d J = view_.pixelsPerSquare(squares).inverse();
        const TagView view((squares / cells_.cell()).array() + cells_.middle(), J / cells_.cell());
        if (cells_.isHidden(squares, kHiddenReach * blur * cells_.cell() * view.slope, view_.dark)) continue;
        const Eigen::Vector2d near = kEdgeReach * blur * view.slope;
        if (!flat && pattern_.isUniform(view.uv - near, view.uv + near)) continue;
        pixels_.push_back({view, (px - view_.px).cwiseQuotient(half), static_cast<double>(row[x])});
      }
    }
    return pixels_.size() >= kFewest;
  }

  /// Light enters linearly, so one solution for it alone is where it starts.
  void startLight() {
    look_.noise = std::numeric_limits<double>::infinity();
    accumulate();
    const Eigen::Matrix<double, 6, 6> A = normal_.block<6, 6>(kBlack, kBlack);
    look_.light = A.ldlt().solve(normal_.block<6, 1>(kBlack, kParameters));
    look_.noise = std::numeric_limits<double>::infinity();  // the residuals so far were those of no light at all
    quick_steps_ = 1;
  }

  bool step() {
    constexpr double kSmallestBlur = 0.3;     // [px]; the pixel's own square
    constexpr double kLargestKurtosis = 1.0;  // what a halo of some hundredths of the light has
    constexpr double kLargestGrowth = 2.0;    // [blurs]
    constexpr double kLargestMove = 0.5;      // [squares]
    accumulate();
    variance_ = normal_(kParameters, kParameters) / (weights_ - kParameters);
    addPriors();
    const Eigen::LDLT<Eigen::Matrix<double, kParameters, kParameters>> ldlt(normal_.topLeftCorner<kParameters, kParameters>());
    const Step step = ldlt.solve(normal_.block<kParameters, 1>(0, kParameters));
    if (!step.allFinite()) return false;
    // Of the residuals that this step leaves.
    const double explained = step.dot(normal_.block<kParameters, 1>(0, kParameters));
    variance_ = std::max(0.1 * variance_, variance_ - explained / (weights_ - kParameters));
    shift_covariance_ = variance_ * ldlt.solve(Eigen::Matrix<double, kParameters, 2>::Identity()).topRows<2>();
    PointSpread& spread = look_.spread;
    const double change = std::clamp(step(kBlur), -spread.blur / 3.0, spread.blur / 3.0);
    last_step_ = step;
    shift_ += step.head<2>();
    tilt_ += step.segment<2>(2);
    spread.blur = std::max(kSmallestBlur, spread.blur + change);
    spread.kurtosis = std::clamp(spread.kurtosis + step(kKurtosis), -kLargestKurtosis, kLargestKurtosis);
    look_.growth = std::clamp(look_.growth + step(kGrowth), -kLargestGrowth * spread.blur, kLargestGrowth * spread.blur);
    look_.light += step.tail<6>();
    return cells_.cell() * shift_.cwiseAbs().maxCoeff() < kLargestMove && tilt_.cwiseAbs().maxCoeff() < kLargestMove;
  }

  /// Few pixels do not tell the shape of the spread; nothing depends on it but how well the model fits.
  void addPriors() {
    constexpr double kKurtosisDeviation = 0.3, kGrowthDeviation = 1.0;  // [-], [px]
    const auto pull = [this](int parameter, double towards, double deviation) {
      const double weight = variance_ / (deviation * deviation);
      normal_(parameter, parameter) += weight;
      normal_(parameter, kParameters) += weight * towards;
    };
    pull(kKurtosis, -look_.spread.kurtosis, kKurtosisDeviation);
    pull(kGrowth, -look_.growth, kGrowthDeviation);
  }

  void accumulate() {
    Rows rows;
    residuals_.clear();
    tally_ = {};
    weights_ = 0.0;
    const double limit = kInliers * look_.noise;
    for (const SaddlePixel& pixel : pixels_) {
      auto row = rows.next();
      const double residual = std::abs(fillRow(pixel, row));
      residuals_.push_back(residual);
      const double weight = residual > limit ? limit / residual : 1.0;
      if (weight < 1.0) row *= std::sqrt(weight);
      weights_ += weight;
    }
    normal_ = rows.take();
    measureResiduals();
  }

  template <typename RowVector>
  double fillRow(const SaddlePixel& pixel, RowVector& row) {
    TagView view = pixel.view;
    const double u = view.uv.x() - cells_.middle(), v = view.uv.y() - cells_.middle();
    view.uv -= shift_ + Eigen::Vector2d(tilt_.x() * v, tilt_.y() * u);
    const Whiteness white = whiteness(pattern_, view, look_.spread, look_.growth);
    const LitPixel lit = fillLit<kBlur>(pixel, white, look_.light, row);
    const Eigen::RowVector2d gradient = -lit.contrast * white.J_value_uv;
    row.template head<4>() << gradient(0), gradient(1), gradient(0) * v, gradient(1) * u;
    row.template tail<kColumns - kParameters - 1>().setZero();
    tally_.add(cells_.cell() * Eigen::Vector2d(u, v), gradient.transpose().cwiseProduct(view.slope), row);
    return lit.residual;
  }

  void measureResiduals() {
    const ResidualNoise measured = residualNoise(residuals_);
    look_.noise = measured.noise;
    outliers_ = measured.outliers;
  }

  const cv::Mat& grey_;
  const SaddleCells& cells_;
  const TagPattern& pattern_;
  SaddleView view_;
  SaddleLook look_;
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero(), tilt_ = Eigen::Vector2d::Zero();  ///< of the pattern [cells], [cells / cell]
  std::vector<SaddlePixel> pixels_;
  std::vector<double> residuals_;  ///< absolute
  EdgeTally tally_;
  Rows::Matrix normal_ = Rows::Matrix::Zero();
  Eigen::Matrix2d shift_covariance_ = Eigen::Matrix2d::Zero();
  Step last_step_ = Step::Zero();
  double variance_ = 0.0;  ///< of the residuals
  double outliers_ = 0.0;
  double weights_ = 0.0;
  int quick_steps_ = 0;  ///< steps before which light is not yet good enough
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

Eigen::Vector2d SaddleView::squaresAt(const Eigen::Vector2d& pixel, const Eigen::Matrix2d& J_squares_px) const {
  const Eigen::Vector2d straight = J_squares_px * (pixel - px);
  const Eigen::Vector2d squares = straight + J_squares_px * (pixel - pixelOf(straight));
  return squares + pixelsPerSquare(squares).inverse() * (pixel - pixelOf(squares));
}

double SaddleFit::sigma() const { return std::sqrt(0.5 * covariance.trace()); }

std::optional<SaddleFit> fitSaddle(const cv::Mat& grey, const SaddleCells& cells, const SaddleView& view, const SaddleLook& start,
                                   int stride) {
  Fit fit(grey, cells, view, start);
  if (!fit.run(stride)) return std::nullopt;
  return fit.result();
}

}  // namespace poecal
