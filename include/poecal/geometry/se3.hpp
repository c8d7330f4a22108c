// SO(3) and SE(3): exponential, logarithm, adjoint and left Jacobian.
//
// Twists are (w; v), rotation first. Perturbations are on the left, T <- exp(delta) T, so delta lives in the left frame of T.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace poecal {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Skew matrix: hat(a) b = a x b.
Eigen::Matrix3d hat(const Eigen::Vector3d& a);

/// Rotation matrix of a rotation vector [rad] (Rodrigues; series below 1e-4 rad, error < 1e-17).
Eigen::Matrix3d expSo3(const Eigen::Vector3d& rotation_vector);
/// Rotation vector of a rotation matrix, |.| <= pi, accurate to rounding also near 0 and pi.
Eigen::Vector3d logSo3(const Eigen::Matrix3d& R);
/// Left Jacobian of SO(3): exp(w + dw) = exp(J_l(w) dw) exp(w) to first order.
Eigen::Matrix3d leftJacobianSo3(const Eigen::Vector3d& w);
/// Inverse of the left Jacobian of SO(3); singular at |w| = 2 pi.
Eigen::Matrix3d leftJacobianInverseSo3(const Eigen::Vector3d& w);

/// exp of the twist (w; v) [rad; m].
Eigen::Isometry3d expSe3(const Vector6d& xi);
/// Twist (w; v) with |w| <= pi whose exponential is T.
Vector6d logSe3(const Eigen::Isometry3d& T);

/// Ad(T) = [R 0; hat(t) R, R], so that exp(Ad(T) xi) = T exp(xi) T^-1.
Matrix6d adjoint(const Eigen::Isometry3d& T);
/// ad(xi) = [hat(w) 0; hat(v) hat(w)], the Omega of Gao, Wang and Jiang (2013): ad(a) b = [a, b].
Matrix6d adjointOfTwist(const Vector6d& xi);

/// Left Jacobian of SE(3): exp(xi + d) = exp(K(xi) d) exp(xi) to first order.
///
///   K = I + (4 - a sin a - 4 cos a)/(2 a^2) Omega + (4a - 5 sin a + a cos a)/(2 a^3) Omega^2
///         + (2 - a sin a - 2 cos a)/(2 a^4) Omega^3 + (2a - 3 sin a + a cos a)/(2 a^5) Omega^4,   a = |w|
///
/// Near a = 0 the coefficients cancel and are taken from their power series instead (error < 1e-15).
/// @see Gao, Wang, Jiang (2013), eq. 19; Selig (2004).
Matrix6d leftJacobianSe3(const Vector6d& xi);

/// The rotation nearest to a 3 x 3 matrix in the Frobenius norm (SVD, det +1).
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& M);
/// Mean of rotations: the rotation nearest to their sum. @throws InvalidArgument if empty.
Eigen::Matrix3d meanRotation(const std::vector<Eigen::Matrix3d>& rotations);

/// Pose from a translation and a quaternion (x, y, z, w) of any length but zero.
Eigen::Isometry3d poseFromQuaternion(const Eigen::Vector3d& position, const Eigen::Vector4d& quaternion_xyzw);
/// Unit quaternion (x, y, z, w) of a pose's rotation, w >= 0 (the first non-zero of x, y, z positive where w = 0).
Eigen::Vector4d quaternionXyzw(const Eigen::Isometry3d& T);
/// Angle of a rotation [rad], 0..pi.
double rotationAngle(const Eigen::Matrix3d& R);

}  // namespace poecal
