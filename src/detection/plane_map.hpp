// From the cells of a tag's pattern to the pixels that a lens without distortion gives, and back.
#pragma once

#include <Eigen/Core>

namespace poecal {

using TagCorners = Eigen::Matrix<double, 2, 4>;  ///< column k: corner k in the contract's order

/// The homography G that takes four points (u, v) of a pattern [cells] to straight pixels [px].
class PlaneMap {
 public:
  PlaneMap(const TagCorners& uv, const TagCorners& px);

  Eigen::Vector2d cellOf(const Eigen::Vector2d& px) const {
    const Eigen::Vector3d h = uv_from_px_.col(0) * px.x() + uv_from_px_.col(1) * px.y() + uv_from_px_.col(2);
    return h.head<2>() * (1.0 / h.z());
  }
  /// 2 x 2, derivative of cellOf() at the pixel `px` of the point `uv` [cells / px].
  Eigen::Matrix2d cellsPerPixel(const Eigen::Vector2d& uv, const Eigen::Vector2d& px) const;
  Eigen::Vector2d pixelOf(const Eigen::Vector2d& uv) const;

  /// 8 x 8, derivative of the four points' pixels, column by column, by the eight numbers m of what a change of G does to the pattern in
  /// its own plane: every point (u, v) of it comes to where (u, v) + f(u, v) was,
  ///   f = (m_0 + m_1 u + m_2 v + u (m_6 u + m_7 v),  m_3 + m_4 u + m_5 v + v (m_6 u + m_7 v)).
  Eigen::Matrix<double, 8, 8> cornersByMotion() const;

 private:
  TagCorners uv_, px_;
  Eigen::Matrix3d px_from_uv_, uv_from_px_;
};

}  // namespace poecal
