// The formulas of the lens models: a point in the camera frame -> the plane whose pixels are px = (fx m_x + cx, fy m_y + cy).
#pragma once

#include <optional>

#include <Eigen/Core>

namespace poecal {

struct DistortionJacobians {
  Eigen::Matrix<double, 2, 3> J_m_p = Eigen::Matrix<double, 2, 3>::Zero();  ///< by p_camera
  /// By the coefficients: columns up to the model's count, in the order of the vector `k`.
  Eigen::Matrix<double, 2, 12> J_m_k = Eigen::Matrix<double, 2, 12>::Zero();
};

/// plumb_bob and rational_polynomial, OpenCV's formula; n = (x, y) = p / p_z, s = |n|^2, k = (k1 k2 p1 p2 k3 k4 k5 k6):
///
///   m = n (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3) + (2 p1 x y + p2 (s + 2 x^2), p1 (s + 2 y^2) + 2 p2 x y)
///
/// Coefficients that `k` does not have are zero, those behind the eighth are not read. Nothing for p_z <= 0, and beyond the radius where
/// the radial part stops growing or the denominator reaches zero. @param jacobians  filled unless nullptr.
std::optional<Eigen::Vector2d> distortPinhole(const Eigen::VectorXd& k, const Eigen::Vector3d& p_camera, DistortionJacobians* jacobians);

/// thin_prism, OpenCV's formula with k = (k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4): as distortPinhole() of the first eight, and
///
///   m = ... + (s1 s + s2 s^2, s3 s + s4 s^2)
std::optional<Eigen::Vector2d> distortThinPrism(const Eigen::VectorXd& k, const Eigen::Vector3d& p_camera, DistortionJacobians* jacobians);

/// equidistant (Kannala and Brandt, cv::fisheye); r = hypot(p_x, p_y), a = atan2(r, p_z), k = (k1 k2 k3 k4):
///
///   m = (p_x, p_y) / r (a + k1 a^3 + k2 a^5 + k3 a^7 + k4 a^9)
///
/// Angles beyond 90 degrees are fine as long as the polynomial grows; nothing behind that, and straight behind the camera.
std::optional<Eigen::Vector2d> distortEquidistant(const Eigen::VectorXd& k, const Eigen::Vector3d& p_camera,
                                                  DistortionJacobians* jacobians);

/// Unit ray that the radial part alone maps to a point at distance `radius` from the centre, in the direction `unit` (to about 1e-9 of
/// its angle's tangent or its angle). Nothing where the profile ends before that.
std::optional<Eigen::Vector3d> rayOfRadiusPinhole(const Eigen::VectorXd& k, const Eigen::Vector2d& unit, double radius);
std::optional<Eigen::Vector3d> rayOfRadiusEquidistant(const Eigen::VectorXd& k, const Eigen::Vector2d& unit, double radius);

}  // namespace poecal
