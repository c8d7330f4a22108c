#include "withheld/leftover.hpp"

#include <Eigen/Dense>

namespace withheld {
namespace {

constexpr double kStep = 1e-5;           // rad or m; central differences are then good to 1e-9 of a column
constexpr double kRankTolerance = 1e-7;  // of columns of length 1

Frame smallMotion(int number, double amount) {
  Vector turn = Vector::Zero(), shift = Vector::Zero();
  (number < 3 ? turn : shift)[number % 3] = amount;
  return motion(turn, shift);
}

template <typename Change>
Eigen::VectorXd difference(const Cell& cell, const std::vector<Shot>& shots, double step, const Change& change) {
  Cell ahead = cell, behind = cell;
  change(ahead, step);
  change(behind, -step);
  return (corners(ahead, shots, {}) - corners(behind, shots, {})) / (2.0 * step);
}

Eigen::MatrixXd lensColumns(const Cell& cell, const std::vector<Shot>& shots, Eigen::Index rows) {
  Eigen::MatrixXd columns(rows, 5);
  columns.col(0) = difference(cell, shots, 1e-3, [](Cell& c, double step) {
    c.lens.fx *= 1.0 + step;
    c.lens.fy *= 1.0 + step;
  });
  columns.col(1) = difference(cell, shots, 1.0, [](Cell& c, double step) { c.lens.cx += step; });
  columns.col(2) = difference(cell, shots, 1.0, [](Cell& c, double step) { c.lens.cy += step; });
  columns.col(3) = difference(cell, shots, 1e-2, [](Cell& c, double step) { c.lens.k1 += step; });
  columns.col(4) = difference(cell, shots, 1e-2, [](Cell& c, double step) { c.lens.k2 += step; });
  return columns;
}

}  // namespace

double repeatabilityOf(const Joint& joint, const Noise& noise) { return noise.repeatability * (joint.slides ? 0.3 : 1.0); }

Leftover::Leftover(const Cell& cell, const std::vector<Shot>& shots, const Noise& noise, bool lens_too) : cell_(cell), shots_(shots) {
  still_ = corners(cell, shots, {});
  const auto n = static_cast<Eigen::Index>(cell.arm.size());
  Eigen::MatrixXd geometry(still_.size(), 6 * n + 12);
  Eigen::MatrixXd by_joint(still_.size(), n);
  for (int number = 0; number < 6; ++number) {
    for (Eigen::Index k = 0; k < n; ++k) {
      geometry.col(6 * k + number) =
          difference(cell, shots, kStep, [&](Cell& c, double s) { moveAxis(c.arm, static_cast<std::size_t>(k), smallMotion(number, s)); });
    }
    geometry.col(6 * n + number) = difference(cell, shots, kStep, [&](Cell& c, double s) { c.T_camera_base = smallMotion(number, s) * c.T_camera_base; });
    geometry.col(6 * n + 6 + number) = difference(cell, shots, kStep, [&](Cell& c, double s) { c.T_flange_target = c.T_flange_target * smallMotion(number, s); });
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    Cell moved = cell;
    std::vector<Shot> ahead = shots, behind = shots;
    for (Shot& shot : ahead) shot.q[k] += kStep;
    for (Shot& shot : behind) shot.q[k] -= kStep;
    by_joint.col(k) = (corners(cell, ahead, {}) - corners(cell, behind, {})) / (2.0 * kStep);
  }

  const Eigen::Index rows = still_.size() / static_cast<Eigen::Index>(shots.size());
  for (std::size_t i = 0; i < shots.size(); ++i) {
    Eigen::MatrixXd covariance = noise.corner * noise.corner * Eigen::MatrixXd::Identity(rows, rows);
    for (Eigen::Index a = 0; a < rows; ++a) {
      for (Eigen::Index b = 0; b < rows; ++b) {
        if (a / 8 == b / 8 && a % 2 == b % 2) covariance(a, b) += noise.common * noise.common;
      }
    }
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::VectorXd moves = by_joint.col(k).segment(static_cast<Eigen::Index>(i) * rows, rows) * repeatabilityOf(cell.arm.joints[static_cast<std::size_t>(k)], noise);
      covariance += moves * moves.transpose();
    }
    factors_.push_back(covariance.llt().matrixL());
  }

  joint_columns_.resize(still_.size(), n);
  for (Eigen::Index k = 0; k < n; ++k) joint_columns_.col(k) = whitened(by_joint.col(k));
  if (lens_too) {
    geometry.conservativeResize(Eigen::NoChange, geometry.cols() + 5);
    geometry.rightCols(5) = lensColumns(cell, shots, still_.size());
  }
  for (Eigen::Index i = 0; i < geometry.cols(); ++i) {
    geometry.col(i) = whitened(geometry.col(i));
    const double length = geometry.col(i).norm();
    if (length > 0.0) geometry.col(i) /= length;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(geometry);
  qr.setThreshold(kRankTolerance);
  span_ = qr.householderQ() * Eigen::MatrixXd::Identity(geometry.rows(), qr.rank());
}

Eigen::VectorXd Leftover::whitened(const Eigen::VectorXd& pixels) const {
  Eigen::VectorXd result = pixels;
  const Eigen::Index rows = pixels.size() / static_cast<Eigen::Index>(factors_.size());
  for (std::size_t i = 0; i < factors_.size(); ++i) {
    factors_[i].triangularView<Eigen::Lower>().solveInPlace(result.segment(static_cast<Eigen::Index>(i) * rows, rows));
  }
  return result;
}

Eigen::MatrixXd Leftover::withoutGeometry(Eigen::MatrixXd whitened_columns) const {
  whitened_columns -= span_ * (span_.transpose() * whitened_columns);
  return whitened_columns;
}

Eigen::VectorXd Leftover::left(const std::vector<Flaw>& flaws) const { return withoutGeometry(whitened(corners(cell_, shots_, flaws) - still_)); }

Eigen::MatrixXd Leftover::columns(const Flaw& flaw) const {
  std::vector<Eigen::VectorXd> found;
  for (std::size_t i = 0; i < flaw.parameters.size(); ++i) {
    if (flaw.parameters[i].usual == 0.0) continue;
    Flaw one = flaw;
    one.scale(0.0);
    one.parameters[i].value = flaw.parameters[i].usual;
    found.push_back(left({one}));
  }
  Eigen::MatrixXd columns(still_.size(), static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = found[i];
  return columns;
}

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
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(1e-5);
  return effect - scaled * qr.solve(effect);
}

}  // namespace withheld
