#include "detection/lens_patch.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace poecal {

LensPatch::Terms LensPatch::terms(const Eigen::Vector2d& x) {
  const double a = x.x(), b = x.y();
  Terms terms;
  terms << 1.0, a, b, a * a, a * b, b * b, a * a * a, a * a * b, a * b * b, b * b * b;
  return terms;
}

std::optional<LensPatch> LensPatch::of(const Camera& camera, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  constexpr int kGrid = 5;  // points a side; four would determine the polynomial
  constexpr double kSmallestZ = 0.17;
  LensPatch patch;
  patch.centre_ = 0.5 * (low + high);
  patch.scale_ = 0.5 * (high - low).maxCoeff();
  patch.is_bent_ = true;
  Eigen::Matrix<double, kGrid * kGrid, kTerms> A;
  Eigen::Matrix<double, kGrid * kGrid, 2> displacements;
  for (int k = 0; k < kGrid * kGrid; ++k) {
    const Eigen::Vector2d unit(2.0 * (k % kGrid) / (kGrid - 1) - 1.0, 2.0 * (k / kGrid) / (kGrid - 1) - 1.0);
    const Eigen::Vector2d px = patch.centre_ + patch.scale_ * unit;
    const std::optional<Eigen::Vector3d> ray = unproject(camera, px);
    if (!ray || ray->z() < kSmallestZ) return std::nullopt;
    const Eigen::Vector2d m = ray->hnormalized();
    A.row(k) = terms(unit).transpose();
    displacements.row(k) = (Eigen::Vector2d(camera.fx * m.x() + camera.cx, camera.fy * m.y() + camera.cy) - px).transpose();
  }
  patch.coefficients_ = A.householderQr().solve(displacements).transpose();
  return patch;
}

LensPatch::Straight LensPatch::straighten(const Eigen::Vector2d& px) const {
  if (!is_bent_) return {px, Eigen::Matrix2d::Identity()};
  const Eigen::Vector2d x = (px - centre_) / scale_;
  const double a = x.x(), b = x.y();
  Eigen::Matrix<double, kTerms, 2> slopes;
  slopes << 0, 0, 1, 0, 0, 1, 2 * a, 0, b, a, 0, 2 * b, 3 * a * a, 0, 2 * a * b, a * a, b * b, 2 * a * b, 0, 3 * b * b;
  return {px + coefficients_ * terms(x), Eigen::Matrix2d::Identity() + coefficients_ * slopes / scale_};
}

Eigen::Vector2d LensPatch::bend(const Eigen::Vector2d& px_straight) const {
  constexpr int kIterations = 6;  // Newton's method on a function that is nearly linear over the patch
  Eigen::Vector2d px = px_straight - coefficients_.col(0);
  for (int k = 0; k < kIterations; ++k) {
    const Straight now = straighten(px);
    px += now.J_straight_px.partialPivLu().solve(px_straight - now.px);
  }
  return px;
}

}  // namespace poecal
