#include "poecal/geometry/se3.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/SVD>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

// sum_k (-1)^k x^k c_k for the power series below, whose terms shrink at least as fast as x^k / (2k)!.
template <std::size_t N>
double alternatingSeries(double x, const std::array<double, N>& coefficients) {
  double sum = 0.0;
  for (std::size_t k = N; k-- > 0;) sum = coefficients[k] - x * sum;
  return sum;
}

// Coefficients of I, Omega, Omega^2 in the SO(3) functions of an angle a; f1 = sin a / a, f2 = (1 - cos a)/a^2, f3 = (a - sin a)/a^3.
struct So3Coefficients {
  double f1, f2, f3;
};

So3Coefficients so3Coefficients(double a) {
  // Below 0.5 rad f3 loses digits to cancellation; eight terms of its series reach 1e-17 there.
  if (a < 0.5) {
    const double x = a * a;
    return {alternatingSeries<8>(
                x, {1.0, 1.0 / 6, 1.0 / 120, 1.0 / 5040, 1.0 / 362880, 1.0 / 39916800, 1.0 / 6227020800.0, 1.0 / 1307674368000.0}),
            alternatingSeries<8>(x, {1.0 / 2, 1.0 / 24, 1.0 / 720, 1.0 / 40320, 1.0 / 3628800, 1.0 / 479001600.0, 1.0 / 87178291200.0,
                                     1.0 / 20922789888000.0}),
            alternatingSeries<8>(x, {1.0 / 6, 1.0 / 120, 1.0 / 5040, 1.0 / 362880, 1.0 / 39916800, 1.0 / 6227020800.0,
                                     1.0 / 1307674368000.0, 1.0 / 355687428096000.0})};
  }
  const double s = std::sin(a);
  const double half = std::sin(0.5 * a);  // 1 - cos a without cancellation
  return {s / a, 2.0 * half * half / (a * a), (a - s) / (a * a * a)};
}

}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

Eigen::Matrix3d expSo3(const Eigen::Vector3d& rotation_vector) {
  const So3Coefficients c = so3Coefficients(rotation_vector.norm());
  const Eigen::Matrix3d W = hat(rotation_vector);
  return Eigen::Matrix3d::Identity() + c.f1 * W + c.f2 * W * W;
}

Eigen::Vector3d logSo3(const Eigen::Matrix3d& R) {
  // Through the quaternion, whose vector part keeps its digits at both ends: small near 0, of unit length near pi.
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-10) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Eigen::Matrix3d leftJacobianSo3(const Eigen::Vector3d& w) {
  const So3Coefficients c = so3Coefficients(w.norm());
  const Eigen::Matrix3d W = hat(w);
  return Eigen::Matrix3d::Identity() + c.f2 * W + c.f3 * W * W;
}

Eigen::Matrix3d leftJacobianInverseSo3(const Eigen::Vector3d& w) {
  const double a = w.norm();
  const Eigen::Matrix3d W = hat(w);
  // 1/a^2 - (1 + cos a)/(2 a sin a) = 1/12 + a^2/720 + a^4/30240 + ...; the next term is below 1e-16 at 0.01 rad.
  double c = 1.0 / 12.0 + a * a / 720.0 + a * a * a * a / 30240.0;
  if (a > 1e-2) c = (1.0 - 0.5 * a / std::tan(0.5 * a)) / (a * a);
  return Eigen::Matrix3d::Identity() - 0.5 * W + c * W * W;
}

Eigen::Isometry3d expSe3(const Vector6d& xi) {
  const Eigen::Vector3d w = xi.head<3>();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSo3(w);
  T.translation() = leftJacobianSo3(w) * xi.tail<3>();
  return T;
}

Vector6d logSe3(const Eigen::Isometry3d& T) {
  Vector6d xi;
  const Eigen::Vector3d w = logSo3(T.linear());
  xi << w, leftJacobianInverseSo3(w) * T.translation();
  return xi;
}

Matrix6d adjoint(const Eigen::Isometry3d& T) {
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = T.linear();
  A.bottomRightCorner<3, 3>() = T.linear();
  A.bottomLeftCorner<3, 3>() = hat(T.translation()) * T.linear();
  return A;
}

Matrix6d adjointOfTwist(const Vector6d& xi) {
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = hat(xi.head<3>());
  A.bottomRightCorner<3, 3>() = A.topLeftCorner<3, 3>();
  A.bottomLeftCorner<3, 3>() = hat(xi.tail<3>());
  return A;
}

Matrix6d leftJacobianSe3(const Vector6d& xi) {
  const double a = xi.head<3>().norm();
  double c1 = 0.0, c2 = 0.0, c3 = 0.0, c4 = 0.0;
  if (a < 1.0) {
    // K = sum_j Omega^j / (j+1)! with the minimal polynomial Omega^5 = -2 a^2 Omega^3 - a^4 Omega folded in. Term m of each series follows
    // from expanding the closed form; ten terms leave less than 1e-18 below 1 rad.
    const double x = a * a;
    double power = 1.0;      // (-x)^m
    double factorial = 1.0;  // (2m)!
    for (int m = 0; m < 10; ++m) {
      if (m > 0) {
        power *= -x;
        factorial *= (2.0 * m - 1.0) * (2.0 * m);
      }
      const double f2 = factorial * (2 * m + 1) * (2 * m + 2);  // (2m+2)!
      const double f3 = f2 * (2 * m + 3);                       // (2m+3)!
      const double f4 = f3 * (2 * m + 4);                       // (2m+4)!
      const double f5 = f4 * (2 * m + 5);                       // (2m+5)!
      c1 += power * (1.0 - m) / f2;
      c2 += power * (1.0 - m) / f3;
      c3 += power * (m + 1.0) / f4;
      c4 += power * (m + 1.0) / f5;
    }
  } else {
    const double s = std::sin(a);
    const double c = std::cos(a);
    c1 = (4.0 - a * s - 4.0 * c) / (2.0 * a * a);
    c2 = (4.0 * a - 5.0 * s + a * c) / (2.0 * a * a * a);
    c3 = (2.0 - a * s - 2.0 * c) / (2.0 * a * a * a * a);
    c4 = (2.0 * a - 3.0 * s + a * c) / (2.0 * a * a * a * a * a);
  }
  const Matrix6d Omega = adjointOfTwist(xi);
  const Matrix6d Omega2 = Omega * Omega;
  return Matrix6d::Identity() + c1 * Omega + c2 * Omega2 + Omega2 * (c3 * Omega + c4 * Omega2);
}

Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  if (R.determinant() < 0.0) {
    Eigen::Matrix3d U = svd.matrixU();
    U.col(2) = -U.col(2);
    R = U * svd.matrixV().transpose();
  }
  return R;
}

Eigen::Matrix3d meanRotation(const std::vector<Eigen::Matrix3d>& rotations) {
  if (rotations.empty()) throw InvalidArgument("mean of no rotations");
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& R : rotations) sum += R;
  return nearestRotation(sum);
}

Eigen::Isometry3d poseFromQuaternion(const Eigen::Vector3d& position, const Eigen::Vector4d& quaternion_xyzw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond q(quaternion_xyzw(3), quaternion_xyzw(0), quaternion_xyzw(1), quaternion_xyzw(2));
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = position;
  return T;
}

Eigen::Vector4d quaternionXyzw(const Eigen::Isometry3d& T) {
  Eigen::Vector4d xyzw = Eigen::Quaterniond(T.linear()).normalized().coeffs();
  double sign = xyzw(3);
  for (int k = 0; k < 3 && sign == 0.0; ++k) sign = xyzw(k);
  return sign < 0.0 ? Eigen::Vector4d(-xyzw) : xyzw;
}

double rotationAngle(const Eigen::Matrix3d& R) { return logSo3(R).norm(); }

}  // namespace poecal
