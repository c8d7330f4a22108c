#include "detection/lens_patch.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace poecal {

LensPatch::Terms LensPatch::terms(const Eigen::Vector2d& x) {
  constexpr int kDegree = 5;
  std::array<double, kDegree + 1> a{1.0}, b{1.0};
  for (std::size_t n = 1; n <= kDegree; ++n) {
    a[n] = a[n - 1] * x.x();
    b[n] = b[n - 1] * x.y();
  }
  Terms terms;
  Eigen::Index term = 0;
  for (std::size_t i = 0; i <= kDegree; ++i) {
    for (std::size_t j = 0; i + j <= kDegree; ++j, ++term) {
      terms.values(term) = a[i] * b[j];
      terms.slopes(term, 0) = i == 0 ? 0.0 : static_cast<double>(i) * a[i - 1] * b[j];
      terms.slopes(term, 1) = j == 0 ? 0.0 : static_cast<double>(j) * a[i] * b[j - 1];
    }
  }
  return terms;
}

std::optional<LensPatch> LensPatch::of(const Camera& camera, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  constexpr int kGrid = 8;  // points a side; six would determine the polynomial
  constexpr double kSmallestZ = 0.17;
  constexpr double kTolerance = 0.2;  // [px]
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
    A.row(k) = terms(unit).values.transpose();
    displacements.row(k) = (Eigen::Vector2d(camera.fx * m.x() + camera.cx, camera.fy * m.y() + camera.cy) - px).transpose();
  }
  patch.coefficients_ = A.householderQr().solve(displacements).transpose();
  if (!((A * patch.coefficients_.transpose() - displacements).cwiseAbs().maxCoeff() < kTolerance)) return std::nullopt;
  return patch;
}

LensPatch::Straight LensPatch::straighten(const Eigen::Vector2d& px) const {
  if (!camera_) return {px, Eigen::Matrix2d::Identity()};
  const Terms at = terms((px - centre_) / scale_);
  // Lazy, because Eigen hands products of this length to the kernels for large matrices, which take three times as long.
  return {px + coefficients_.lazyProduct(at.values), Eigen::Matrix2d::Identity() + coefficients_.lazyProduct(at.slopes) / scale_};
}

LensPatch::Straight LensPatch::straightenExactly(const Eigen::Vector2d& px) const {
  Straight straight = straighten(px);
  straight.px = exactly(px, straight);
  return straight;
}

Eigen::Vector2d LensPatch::exactly(const Eigen::Vector2d& px, const Straight& straight) const {
  return camera_ ? straight.px + straight.J_straight_px * (px - bend(straight.px)) : straight.px;
}

Eigen::Vector2d LensPatch::bend(const Eigen::Vector2d& px_straight) const {
  if (!camera_) return px_straight;
  const Eigen::Vector3d ray((px_straight.x() - camera_->cx) / camera_->fx, (px_straight.y() - camera_->cy) / camera_->fy, 1.0);
  return project(*camera_, ray).value_or(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace poecal
