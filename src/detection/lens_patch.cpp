#include "detection/lens_patch.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace poecal {

Eigen::Matrix<double, LensPatch::kTerms, 1> LensPatch::terms(const Eigen::Vector2d& x) {
  Eigen::Matrix<double, kTerms, 1> values;
  Eigen::Index term = 0;
  double power_x = 1.0;
  for (int i = 0; i <= kDegree; ++i, power_x *= x.x()) {
    double power = power_x;
    for (int j = 0; i + j <= kDegree; ++j, power *= x.y()) values(term++) = power;
  }
  return values;
}

std::optional<LensPatch> LensPatch::of(const Camera& camera, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  constexpr int kGrid = 8;  // points a side; six would determine the polynomial
  constexpr double kSmallestZ = 0.17;
  constexpr double kTolerance = 0.2;    // [px]
  constexpr double kNegligible = 1e-6;  // [px]; a thousandth of what the best picture leaves
  LensPatch patch;
  patch.centre_ = 0.5 * (low + high);
  patch.scale_ = 0.5 * (high - low).maxCoeff();
  patch.camera_ = camera;
  Eigen::Matrix<double, kGrid * kGrid, kTerms> A;
  Eigen::Matrix<double, kGrid * kGrid, 2> displacements;
  // Chebyshev's points, which leave the same error in the middle and at the rim.
  const auto node = [](int k) { return std::cos(std::numbers::pi * (k + 0.5) / kGrid); };
  for (int k = 0; k < kGrid * kGrid; ++k) {
    const Eigen::Vector2d unit(node(k % kGrid), node(k / kGrid));
    const Eigen::Vector2d px = patch.centre_ + patch.scale_ * unit;
    const std::optional<Eigen::Vector3d> ray = unproject(camera, px);
    if (!ray || ray->z() < kSmallestZ) return std::nullopt;
    const Eigen::Vector2d m = ray->hnormalized();
    A.row(k) = terms(unit).transpose();
    displacements.row(k) = (Eigen::Vector2d(camera.fx * m.x() + camera.cx, camera.fy * m.y() + camera.cy) - px).transpose();
  }
  patch.coefficients_ = A.householderQr().solve(displacements).transpose();
  const double left = (A * patch.coefficients_.transpose() - displacements).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  if (!(left < kTolerance)) return std::nullopt;
  patch.needs_newton_ = left > kNegligible;
  return patch;
}

LensPatch::Row LensPatch::row(double y) const {
  Row row;
  row.patch_ = this;
  row.y_ = y;
  const double b = (y - centre_.y()) / scale_;
  Eigen::Index first = 0;
  for (int i = 0; i <= kDegree; first += kDegree - i + 1, ++i) {
    Eigen::Vector2d value = Eigen::Vector2d::Zero(), slope = Eigen::Vector2d::Zero();
    for (int j = kDegree - i; j >= 0; --j) {
      slope = slope * b + value;
      value = value * b + coefficients_.col(first + j);
    }
    row.values_.col(i) = value;
    row.slopes_.col(i) = slope;
  }
  return row;
}

LensPatch::Straight LensPatch::Row::straighten(double x) const {
  const Eigen::Vector2d px(x, y_);
  if (!patch_->camera_) return {px, Eigen::Matrix2d::Identity()};
  const double a = (x - patch_->centre_.x()) / patch_->scale_;
  Eigen::Vector2d value = Eigen::Vector2d::Zero(), by_x = Eigen::Vector2d::Zero(), by_y = Eigen::Vector2d::Zero();
  for (Eigen::Index i = kDegree; i >= 0; --i) {
    by_x = by_x * a + value;
    value = value * a + values_.col(i);
    by_y = by_y * a + slopes_.col(i);
  }
  Straight straight;
  straight.px = px + value;
  straight.J_straight_px.col(0) += by_x / patch_->scale_;
  straight.J_straight_px.col(1) += by_y / patch_->scale_;
  return straight;
}

LensPatch::Straight LensPatch::Row::straightenExactly(double x) const {
  Straight straight = straighten(x);
  if (patch_->needs_newton_) straight.px += straight.J_straight_px * (Eigen::Vector2d(x, y_) - patch_->bend(straight.px));
  return straight;
}

Eigen::Vector2d LensPatch::bend(const Eigen::Vector2d& px_straight) const {
  if (!camera_) return px_straight;
  const Eigen::Vector3d ray((px_straight.x() - camera_->cx) / camera_->fx, (px_straight.y() - camera_->cy) / camera_->fy, 1.0);
  return project(*camera_, ray).value_or(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace poecal
