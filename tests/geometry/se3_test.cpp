#include "poecal/geometry/se3.hpp"

#include <gmock/gmock.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using test::IsNear;
using test::PoseIsNear;

Eigen::Matrix4d hatSe3(const Vector6d& xi) {
  Eigen::Matrix4d X = Eigen::Matrix4d::Zero();
  X.topLeftCorner<3, 3>() = hat(xi.head<3>());
  X.topRightCorner<3, 1>() = xi.tail<3>();
  return X;
}

// Angles where a branch begins or digits are lost: zero, tiny, the series limits, near pi, beyond pi.
const double kAwkwardAngles[] = {0.0,     1e-12,   1e-8, 1e-5, 1e-3,    0.01,         0.49999, 0.50001,
                                 0.99999, 1.00001, 2.0,  3.0,  3.14159, 3.1415926535, 4.0,     6.0};

Vector6d awkwardTwist(Rng& rng, double angle) {
  Vector6d xi;
  xi << angle * test::uniformVector(rng, 3, 1.0).normalized(), test::uniformVector(rng, 3, 1.0);
  return xi;
}

TEST(Se3, ExponentialMatchesMatrixExponential) {
  Rng rng = test::rngOfThisTest();
  for (const double angle : kAwkwardAngles) {
    const Vector6d xi = awkwardTwist(rng, angle);
    // Padé with squaring keeps about 1e-14 at norms of a few.
    EXPECT_THAT(Eigen::Matrix4d(expSe3(xi).matrix()), IsNear(Eigen::Matrix4d(hatSe3(xi).exp()), 1e-13)) << "angle " << angle;
  }
}

TEST(Se3, LogarithmUndoesExponential) {
  Rng rng = test::rngOfThisTest();
  for (const double angle : kAwkwardAngles) {
    if (angle > 3.1415926) continue;
    const Vector6d xi = awkwardTwist(rng, angle);
    // v passes through the inverse of the left Jacobian, whose norm stays below 2 up to pi.
    EXPECT_THAT(logSe3(expSe3(xi)), IsNear(xi, 1e-13)) << "angle " << angle;
  }
}

TEST(Se3, LogarithmAtExactlyHalfATurn) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, 0, -0.8)}) {
    const Eigen::Matrix3d R = 2.0 * axis * axis.transpose() - Eigen::Matrix3d::Identity();
    const Eigen::Vector3d w = logSo3(R);
    EXPECT_NEAR(w.norm(), M_PI, 1e-15);
    EXPECT_THAT(expSo3(w), IsNear(R, 1e-15));
  }
}

TEST(Se3, AdjointCarriesTwists) {
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Isometry3d T = test::randomPose(rng);
    const Vector6d xi = test::uniformVector(rng, 6, 2.0);
    const Eigen::Matrix4d expected = T.matrix() * hatSe3(xi) * T.inverse().matrix();
    EXPECT_THAT(hatSe3(adjoint(T) * xi), IsNear(expected, 1e-14));
  }
}

TEST(Se3, AdjointOfExponentialIsExponentialOfAdjoint) {
  Rng rng = test::rngOfThisTest();
  for (const double angle : kAwkwardAngles) {
    const Vector6d xi = awkwardTwist(rng, angle);
    EXPECT_THAT(adjoint(expSe3(xi)), IsNear(Matrix6d(adjointOfTwist(xi).exp()), 1e-12)) << "angle " << angle;
  }
}

TEST(Se3, LeftJacobianIsTheIntegralOfTheAdjoint) {
  // Second formula: K = integral_0^1 exp(s Omega) ds = the top-right block of exp([Omega I; 0 0]).
  Rng rng = test::rngOfThisTest();
  for (const double angle : kAwkwardAngles) {
    const Vector6d xi = awkwardTwist(rng, angle);
    Eigen::Matrix<double, 12, 12> block = Eigen::Matrix<double, 12, 12>::Zero();
    block.topLeftCorner<6, 6>() = adjointOfTwist(xi);
    block.topRightCorner<6, 6>().setIdentity();
    const Eigen::Matrix<double, 12, 12> exponential = block.exp();
    EXPECT_THAT(leftJacobianSe3(xi), IsNear(Matrix6d(exponential.topRightCorner<6, 6>()), 1e-12)) << "angle " << angle;
  }
}

TEST(Se3, LeftJacobianIsTheDerivativeOfTheExponential) {
  constexpr double kStep = 1e-6;  // truncation 1e-12, rounding 1e-10
  Rng rng = test::rngOfThisTest();
  for (const double angle : {0.0, 1e-4, 0.3, 1.5, 3.0}) {
    const Vector6d xi = awkwardTwist(rng, angle);
    const Matrix6d K = leftJacobianSe3(xi);
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = kStep * Vector6d::Unit(k);
      const Vector6d numeric = logSe3(expSe3(xi + step) * expSe3(xi - step).inverse()) / (2.0 * kStep);
      EXPECT_THAT(Vector6d(K.col(k)), IsNear(numeric, 1e-8)) << "angle " << angle << ", column " << k;
    }
  }
}

TEST(Se3, InverseOfTheLeftJacobianOfSo3) {
  Rng rng = test::rngOfThisTest();
  for (const double angle : kAwkwardAngles) {
    const Eigen::Vector3d w = awkwardTwist(rng, angle).head<3>();
    EXPECT_THAT(Eigen::Matrix3d(leftJacobianInverseSo3(w) * leftJacobianSo3(w)),
                IsNear(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), 1e-12));
  }
}

TEST(Se3, MeanOfRotationsAroundAMeanIsThatMean) {
  Rng rng = test::rngOfThisTest();
  const Eigen::Matrix3d R = test::randomPose(rng).linear();
  std::vector<Eigen::Matrix3d> rotations;
  for (int k = 0; k < 3; ++k) {
    rotations.push_back(expSo3(0.3 * Eigen::Vector3d::Unit(k)) * R);
    rotations.push_back(expSo3(-0.3 * Eigen::Vector3d::Unit(k)) * R);
  }
  EXPECT_THAT(meanRotation(rotations), IsNear(R, 1e-14));
}

TEST(Se3, QuaternionOrderIsXyzw) {
  const Eigen::Isometry3d T = poseFromQuaternion({1, 2, 3}, {0, 0, std::sqrt(0.5), std::sqrt(0.5)});
  EXPECT_THAT(Eigen::Vector3d(T * Eigen::Vector3d(1, 0, 0)), IsNear(Eigen::Vector3d(1, 3, 3), 1e-15));
  EXPECT_THAT(quaternionXyzw(T), IsNear(Eigen::Vector4d(0, 0, std::sqrt(0.5), std::sqrt(0.5)), 1e-15));
}

}  // namespace
}  // namespace poecal
