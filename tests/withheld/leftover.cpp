#include "withheld/leftover.hpp"

#include <Eigen/Dense>

namespace withheld {
namespace {

constexpr double kStep = 1e-5;  // rad or m; central differences are then good to 1e-9 of a column

template <typename Change>
Eigen::VectorXd difference(const Cell& cell, const std::vector<Shot>& shots, const Observe& observe, double step, const Change& change) {
  Cell ahead = cell, behind = cell;
  change(ahead, step);
  change(behind, -step);
  return (observe(ahead, shots, {}) - observe(behind, shots, {})) / (2.0 * step);
}

Eigen::MatrixXd lensColumns(const Cell& cell, const std::vector<Shot>& shots, const Observe& observe, Eigen::Index rows) {
  Eigen::MatrixXd columns(rows, kLensColumns);
  columns.col(0) = difference(cell, shots, observe, 1e-3, [](Cell& c, double step) {
    c.lens.fx *= 1.0 + step;
    c.lens.fy *= 1.0 + step;
  });
  columns.col(1) = difference(cell, shots, observe, 1.0, [](Cell& c, double step) { c.lens.cx += step; });
  columns.col(2) = difference(cell, shots, observe, 1.0, [](Cell& c, double step) { c.lens.cy += step; });
  columns.col(3) = difference(cell, shots, observe, 1e-2, [](Cell& c, double step) { c.lens.k1 += step; });
  columns.col(4) = difference(cell, shots, observe, 1e-2, [](Cell& c, double step) { c.lens.k2 += step; });
  return columns;
}

}  // namespace

double repeatabilityOf(const Joint& joint, const Noise& noise) { return noise.repeatability * (joint.slides ? 0.3 : 1.0); }

Eigen::VectorXd observeCorners(const Cell& cell, const std::vector<Shot>& shots, const std::vector<Flaw>& flaws) {
  return corners(cell, shots, flaws);
}

Frame smallMotion(int number, double amount) {
  Vector turn = Vector::Zero(), shift = Vector::Zero();
  (number < 3 ? turn : shift)[number % 3] = amount;
  return motion(turn, shift);
}

Eigen::MatrixXd geometryColumns(const Cell& cell, const std::vector<Shot>& shots, bool lens_too, const Observe& observe) {
  const auto n = static_cast<Eigen::Index>(cell.arm.size());
  const Eigen::Index rows = observe(cell, shots, {}).size();
  Eigen::MatrixXd columns(rows, 6 * n + 12 + (lens_too ? kLensColumns : 0));
  for (int number = 0; number < 6; ++number) {
    for (Eigen::Index k = 0; k < n; ++k) {
      columns.col(6 * k + number) = difference(cell, shots, observe, kStep, [&](Cell& c, double step) {
        moveAxis(c.arm, static_cast<std::size_t>(k), smallMotion(number, step));
      });
    }
    columns.col(6 * n + number) = difference(
        cell, shots, observe, kStep, [&](Cell& c, double step) { c.T_camera_mount = smallMotion(number, step) * c.T_camera_mount; });
    columns.col(6 * n + 6 + number) = difference(
        cell, shots, observe, kStep, [&](Cell& c, double step) { c.T_mount_target = c.T_mount_target * smallMotion(number, step); });
  }
  if (lens_too) columns.rightCols(kLensColumns) = lensColumns(cell, shots, observe, rows);
  return columns;
}

Eigen::MatrixXd flawColumns(const Cell& cell, const std::vector<Shot>& shots, const Flaw& flaw, const Observe& observe) {
  const Eigen::VectorXd still = observe(cell, shots, {});
  std::vector<Eigen::VectorXd> found;
  for (std::size_t i = 0; i < flaw.parameters.size(); ++i) {
    if (flaw.parameters[i].usual == 0.0) continue;
    Flaw one = flaw;
    one.scale(0.0);
    one.parameters[i].value = flaw.parameters[i].usual;
    found.push_back(observe(cell, shots, {one}) - still);
  }
  Eigen::MatrixXd columns(still.size(), static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = found[i];
  return columns;
}

std::vector<Eigen::MatrixXd> noiseFactors(const Cell& cell, const std::vector<Shot>& shots, const Noise& noise) {
  const auto rows = 8 * static_cast<Eigen::Index>(cell.tags.size());
  std::vector<Eigen::MatrixXd> factors;
  for (const Shot& shot : shots) {
    Eigen::MatrixXd covariance = noise.corner * noise.corner * Eigen::MatrixXd::Identity(rows, rows);
    for (Eigen::Index a = 0; a < rows; ++a) {
      for (Eigen::Index b = 0; b < rows; ++b) {
        if (a / 8 == b / 8 && a % 2 == b % 2) covariance(a, b) += noise.common * noise.common;
      }
    }
    for (Eigen::Index k = 0; k < shot.q.size(); ++k) {
      const auto joint = static_cast<std::size_t>(k);
      const auto scatter = noise.scatter.find(joint);
      const double sigma =
          std::hypot(repeatabilityOf(cell.arm.joints[joint], noise), scatter == noise.scatter.end() ? 0.0 : scatter->second);
      if (sigma == 0.0) continue;
      Shot ahead = shot, behind = shot;
      ahead.q[k] += kStep;
      behind.q[k] -= kStep;
      const Eigen::VectorXd moves = (corners(cell, ahead, {}) - corners(cell, behind, {})) / (2.0 * kStep);
      covariance += sigma * sigma * moves * moves.transpose();
    }
    factors.push_back(covariance.llt().matrixL());
  }
  return factors;
}

Eigen::MatrixXd whiten(Eigen::MatrixXd columns, const std::vector<Eigen::MatrixXd>& factors) {
  Eigen::Index row = 0;
  for (const Eigen::MatrixXd& factor : factors) {
    auto part = columns.middleRows(row, factor.rows());
    factor.triangularView<Eigen::Lower>().solveInPlace(part);
    row += factor.rows();
  }
  return columns;
}

Eigen::VectorXd columnScales(const Eigen::MatrixXd& columns) {
  constexpr double kRounding = 1e-7;
  const Eigen::VectorXd lengths = columns.colwise().norm().transpose();
  const double least = kRounding * lengths.maxCoeff();
  return lengths.unaryExpr([&](double length) { return length > least ? 1.0 / length : 0.0; });
}

Eigen::MatrixXd spanOf(const Eigen::MatrixXd& columns, double tolerance) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns * columnScales(columns).asDiagonal());
  qr.setThreshold(tolerance);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

Solution solveSmallest(const Eigen::MatrixXd& columns, const Eigen::VectorXd& right) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(kRankTolerance);
  decomposition.compute(columns);
  return {decomposition.solve(right), decomposition.rank()};
}

Leftover::Leftover(const Cell& cell, const std::vector<Shot>& shots, const Noise& noise, bool lens_too)
    : Leftover(cell, shots, noiseFactors(cell, shots, noise), lens_too, observeCorners) {}

Leftover::Leftover(const Cell& cell, const std::vector<Shot>& shots, std::vector<Eigen::MatrixXd> factors, bool lens_too, Observe observe)
    : cell_(cell), shots_(shots), observe_(std::move(observe)), still_(observe_(cell, shots, {})), factors_(std::move(factors)) {
  span_ = spanOf(whiten(geometryColumns(cell, shots, lens_too, observe_), factors_), kRankTolerance);
}

Eigen::MatrixXd Leftover::withoutGeometry(const Eigen::MatrixXd& observed) const {
  Eigen::MatrixXd columns = whiten(observed, factors_);
  columns -= span_ * (span_.transpose() * columns);
  return columns;
}

Eigen::VectorXd Leftover::left(const std::vector<Flaw>& flaws) const { return withoutGeometry(observe_(cell_, shots_, flaws) - still_); }

Eigen::MatrixXd Leftover::columns(const Flaw& flaw) const { return withoutGeometry(flawColumns(cell_, shots_, flaw, observe_)); }

Eigen::VectorXd Leftover::besides(const Eigen::VectorXd& effect, const Eigen::MatrixXd& columns) {
  // Columns that are next to nothing would fit rounding errors.
  constexpr double kLeast = 1e-5;
  Eigen::MatrixXd scaled(columns.rows(), 0);
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const double length = columns.col(i).norm();
    if (length < kLeast) continue;
    scaled.conservativeResize(Eigen::NoChange, scaled.cols() + 1);
    scaled.rightCols(1) = columns.col(i) / length;
  }
  if (scaled.cols() == 0) return effect;
  const Eigen::MatrixXd span = spanOf(scaled, kLeftTolerance);
  return effect - span * (span.transpose() * effect);
}

}  // namespace withheld
