#include "detection/plane_map.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace poecal {

PlaneMap::PlaneMap(const TagCorners& uv, const TagCorners& px) : uv_(uv), px_(px) {
  Eigen::Matrix<double, 8, 8> A = Eigen::Matrix<double, 8, 8>::Zero();
  for (int k = 0; k < 4; ++k) {
    const double u = uv(0, k), v = uv(1, k);
    A.row(2 * k) << u, v, 1, 0, 0, 0, -px(0, k) * u, -px(0, k) * v;
    A.row(2 * k + 1) << 0, 0, 0, u, v, 1, -px(1, k) * u, -px(1, k) * v;
  }
  const Eigen::Matrix<double, 8, 1> g = A.partialPivLu().solve(px.reshaped());
  px_from_uv_ << g(0), g(1), g(2), g(3), g(4), g(5), g(6), g(7), 1.0;
  uv_from_px_ = px_from_uv_.inverse();
}

Eigen::Matrix2d PlaneMap::cellsPerPixel(const Eigen::Vector2d& uv, const Eigen::Vector2d& px) const {
  return (uv_from_px_.topLeftCorner<2, 2>() - uv * uv_from_px_.row(2).head<2>()) /
         (uv_from_px_.row(2).head<2>().dot(px) + uv_from_px_(2, 2));
}

Eigen::Vector2d PlaneMap::pixelOf(const Eigen::Vector2d& uv) const { return (px_from_uv_ * uv.homogeneous()).hnormalized(); }

Eigen::Matrix<double, 8, 8> PlaneMap::cornersByMotion() const {
  Eigen::Matrix<double, 8, 8> J_corners_m;
  for (int k = 0; k < 4; ++k) {
    const double u = uv_(0, k), v = uv_(1, k);
    Eigen::Matrix<double, 2, 8> J_uv_m;
    J_uv_m << 1, u, v, 0, 0, 0, u * u, u * v,  //
        0, 0, 0, 1, u, v, u * v, v * v;
    J_corners_m.middleRows<2>(2 * k) = cellsPerPixel(uv_.col(k), px_.col(k)).inverse() * J_uv_m;
  }
  return J_corners_m;
}

}  // namespace poecal
