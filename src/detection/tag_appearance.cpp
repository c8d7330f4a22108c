#include "detection/tag_appearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace poecal {
namespace {

constexpr double kReach = 4.0;        // [blurs]; beyond it a step is complete to 3e-5
constexpr std::size_t kMaxLines = 9;  // within reach either way, for cells of no less than one blur

/// A blurred step at its distance from the pixel.
struct Step {
  double a;         ///< [blurs]
  double cdf;       ///< S(a)
  double pdf;       ///< S'(a)
  double gaussian;  ///< phi(a)
  double by_kurtosis;
};

/// The normal distribution between tabulated points, by cubics that meet in value and slope: to 3e-10 in value and 1e-6 in slope, a tenth
/// of erfc's time.
class NormalTable {
 public:
  NormalTable() {
    constexpr double kInverseRootTwoPi = 0.3989422804014327;
    for (std::size_t k = 0; k < kNodes; ++k) {
      const double a = static_cast<double>(k) / kPerUnit - kRange;
      nodes_[k] = {0.5 * std::erfc(-a / std::numbers::sqrt2), kInverseRootTwoPi * std::exp(-0.5 * a * a) / kPerUnit};
    }
  }

  struct Value {
    double cdf = 0.0, pdf = 0.0;
  };
  Value at(double a) const {
    if (!(std::abs(a) < kRange)) return {a > 0.0 ? 1.0 : 0.0, 0.0};
    const double place = (a + kRange) * kPerUnit;
    const auto k = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(k);
    const Node &low = nodes_[k], &high = nodes_[k + 1];
    const double rise = high.value - low.value;
    const double c2 = 3.0 * rise - 2.0 * low.slope - high.slope, c3 = low.slope + high.slope - 2.0 * rise;
    return {low.value + t * (low.slope + t * (c2 + t * c3)), kPerUnit * (low.slope + t * (2.0 * c2 + 3.0 * t * c3))};
  }

 private:
  static constexpr int kRange = 6, kPerUnit = 64;
  static constexpr std::size_t kNodes = 2 * kRange * kPerUnit + 1;
  struct Node {
    double value = 0.0, slope = 0.0;  ///< the slope by one node
  };
  std::array<Node, kNodes> nodes_;
};

Step stepAt(double a, double kurtosis) {
  static const NormalTable kTable;
  const NormalTable::Value normal = kTable.at(a);
  const double a2 = a * a;
  const double by_kurtosis = -a * (a2 - 3.0) * normal.pdf / 24.0;
  return {a, normal.cdf + kurtosis * by_kurtosis, normal.pdf * (1.0 + kurtosis / 24.0 * (a2 * (a2 - 6.0) + 3.0)), normal.pdf, by_kurtosis};
}

/// The lines of one direction within reach. Each stands at two places, where growth moves it back and where it moves it on; most steps
/// are never asked for, so that they are worked out when they are.
class Lines {
 public:
  /// @param slope, width  of the view, along this direction. @param per_blur  1 / blur.
  Lines(double coordinate, double slope, double width, const PointSpread& spread, double per_blur, double growth)
      : per_cell_(width * per_blur), shift_(growth * per_blur), kurtosis_(spread.kurtosis) {
    const double reach = kReach * spread.blur * slope;
    first_ = cellAt(coordinate - reach) + 1;
    const int last = cellAt(coordinate + reach);
    count_ = std::min(kMaxLines, static_cast<std::size_t>(std::max(0, last - first_ + 1)));
    beyond_first_ = coordinate - first_;
  }

  int first() const { return first_; }
  std::size_t count() const { return count_; }
  const Step& at(std::size_t k, int shift) {
    const std::size_t place = 2 * k + (shift > 0 ? 1 : 0);
    const unsigned bit = 1U << place;
    if ((known_ & bit) == 0) {
      const double distance = (beyond_first_ - static_cast<double>(k)) * per_cell_;
      steps_[place] = stepAt(shift > 0 ? distance - shift_ : distance + shift_, kurtosis_);
      known_ |= bit;
    }
    return steps_[place];
  }

 private:
  double per_cell_, shift_, kurtosis_, beyond_first_ = 0.0;
  int first_ = 0;
  std::size_t count_ = 0;
  unsigned known_ = 0;                     ///< a bit for each of steps_ that is worked out
  std::array<Step, 2 * kMaxLines> steps_;  ///< the others hold nothing: to clear them would take longer than all the rest
};

/// The sum so far, its derivatives by lengths in blurs until it is finished.
class Sum {
 public:
  explicit Sum(double start) { whiteness_.value = start; }

  void addAlongU(int weight, const Step& step) {
    addStep(weight, step);
    derive(weight * step.pdf, step.a, weight, 0.0, 0.0, 0);
  }
  void addAlongV(int weight, const Step& step) {
    addStep(weight, step);
    derive(0.0, 0.0, 0, weight * step.pdf, step.a, weight);
  }
  void addTurn(const Turn& turn, const Step& u, const Step& v, double rho) {
    // Mehler's series with Hermite polynomials: d/da [He_n(a) phi(a)] = -He_(n+1)(a) phi(a).
    const double a2 = u.a * u.a, b2 = v.a * v.a;
    const std::array<double, 5> A{1.0, u.a, a2 - 1.0, u.a * (a2 - 3.0), a2 * (a2 - 6.0) + 3.0};
    const std::array<double, 5> B{1.0, v.a, b2 - 1.0, v.a * (b2 - 3.0), b2 * (b2 - 6.0) + 3.0};
    double value = 0.0, by_a = 0.0, by_b = 0.0, factor = u.gaussian * v.gaussian;
    for (std::size_t n = 0; n < 4; ++n) {
      factor *= rho / static_cast<double>(n + 1);
      value += factor * A[n] * B[n];
      by_a -= factor * A[n + 1] * B[n];
      by_b -= factor * A[n] * B[n + 1];
    }
    whiteness_.value += turn.weight * (u.cdf * v.cdf + value);
    whiteness_.J_value_kurtosis += turn.weight * (u.by_kurtosis * v.cdf + u.cdf * v.by_kurtosis);
    derive(turn.weight * (u.pdf * v.cdf + by_a), u.a, turn.shift_u, turn.weight * (u.cdf * v.pdf + by_b), v.a, turn.shift_v);
  }

  Whiteness finish(const Eigen::Vector2d& width, double per_blur) {
    whiteness_.J_value_uv(0) *= per_blur * width.x();
    whiteness_.J_value_uv(1) *= per_blur * width.y();
    whiteness_.J_value_blur *= per_blur;
    whiteness_.J_value_growth *= per_blur;
    return whiteness_;
  }

 private:
  void addStep(int weight, const Step& step) {
    whiteness_.value += weight * step.cdf;
    whiteness_.J_value_kurtosis += weight * step.by_kurtosis;
  }
  void derive(double by_a, double a, int shift_u, double by_b, double b, int shift_v) {
    whiteness_.J_value_uv(0) += by_a;
    whiteness_.J_value_uv(1) += by_b;
    whiteness_.J_value_blur -= by_a * a + by_b * b;
    whiteness_.J_value_growth -= by_a * shift_u + by_b * shift_v;
  }

  Whiteness whiteness_;
};

}  // namespace

TagView::TagView(const Eigen::Vector2d& coordinates, const Eigen::Matrix2d& J_uv_px)
    : uv(coordinates),
      slope(J_uv_px.rowwise().norm()),
      width(slope.cwiseInverse()),
      cosine(J_uv_px.row(0).dot(J_uv_px.row(1)) * width.prod()) {}

Whiteness whiteness(const TagPattern& pattern, const TagView& view, const PointSpread& spread, double growth) {
  const double per_blur = 1.0 / spread.blur;
  Lines across_u(view.uv.x(), view.slope.x(), view.width.x(), spread, per_blur, growth);
  Lines across_v(view.uv.y(), view.slope.y(), view.width.y(), spread, per_blur, growth);
  const int column = across_u.first(), row = across_v.first();
  Sum sum(pattern.white(column - 1, row - 1));
  for (std::size_t i = 0; i < across_u.count(); ++i) {
    const int k = column + static_cast<int>(i);
    const int step = pattern.white(k, row - 1) - pattern.white(k - 1, row - 1);
    if (step != 0) sum.addAlongU(step, across_u.at(i, step));
  }
  for (std::size_t j = 0; j < across_v.count(); ++j) {
    const int k = row + static_cast<int>(j);
    const int step = pattern.white(column - 1, k) - pattern.white(column - 1, k - 1);
    if (step != 0) sum.addAlongV(step, across_v.at(j, step));
  }
  for (std::size_t j = 0; j < across_v.count(); ++j) {
    for (std::size_t i = 0; i < across_u.count(); ++i) {
      for (const Turn& turn : pattern.turns(column + static_cast<int>(i), row + static_cast<int>(j))) {
        if (turn.weight != 0) sum.addTurn(turn, across_u.at(i, turn.shift_u), across_v.at(j, turn.shift_v), view.cosine);
      }
    }
  }
  return sum.finish(view.width, per_blur);
}

Surroundings surroundings(const TagPattern& pattern, const TagView& view, double edge_reach, double unknown_reach) {
  const Eigen::Vector2d near = edge_reach * view.slope;
  if (pattern.isUniform(view.uv - near, view.uv + near)) return Surroundings::kFlat;
  const Eigen::Vector2d far = unknown_reach * view.slope;
  for (const double v : {view.uv.y() - far.y(), view.uv.y() + far.y()}) {
    for (const double u : {view.uv.x() - far.x(), view.uv.x() + far.x()}) {
      if (!pattern.isKnown(cellAt(u), cellAt(v))) return Surroundings::kUnknown;
    }
  }
  return Surroundings::kEdges;
}

}  // namespace poecal
