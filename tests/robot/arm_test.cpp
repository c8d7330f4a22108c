#include "poecal/robot/arm.hpp"

#include <cmath>
#include <limits>

#include <Eigen/SVD>
#include <gmock/gmock.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "poecal/core/error.hpp"
#include "support/arms.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using test::IsNear;
using test::PoseIsNear;
using test::randomArm;
using test::uniformVector;

constexpr double kRounding = 1e-13;  // a few hundred operations on numbers of order one

constexpr double kStep = 1e-6;  // central differences: truncation 1e-12, rounding 1e-10
constexpr double kDifferenceTolerance = 1e-8;

Eigen::Matrix4d matrixOfTwist(const Vector6d& xi) {
  Eigen::Matrix4d X = Eigen::Matrix4d::Zero();
  X.topLeftCorner<3, 3>() = hat(xi.head<3>());
  X.topRightCorner<3, 1>() = xi.tail<3>();
  return X;
}

// (T(+) T(-)^-1)^v / 2h: the derivative on the left, as all Jacobians here.
Vector6d leftDifference(const Eigen::Isometry3d& plus, const Eigen::Isometry3d& minus) {
  return logSe3(plus * minus.inverse()) / (2.0 * kStep);
}

Eigen::Index rankOf(const Eigen::MatrixXd& M) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(M);
  svd.setThreshold(1e-9);  // between rounding (1e-15) and the weakest true direction of a random arm (above 1e-4)
  return svd.rank();
}

TEST(Arm, ForwardKinematicsMatchesMatrixExponential) {
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 10; ++trial) {
    const Arm arm = randomArm(rng, "RRPRPR");
    const Eigen::VectorXd q = uniformVector(rng, 6, 3.0);
    Eigen::Matrix4d expected = Eigen::Matrix4d::Identity();
    for (int k = 0; k < 6; ++k) expected *= (matrixOfTwist(arm.joints[static_cast<std::size_t>(k)].xi) * q(k)).exp();
    expected *= matrixOfTwist(arm.gamma).exp();
    EXPECT_THAT(Eigen::Matrix4d(forwardKinematics(arm, q).matrix()), IsNear(expected, kRounding)) << "trial " << trial;
  }
}

TEST(Arm, ForwardKinematicsOfAScaraByHand) {
  Arm arm;
  arm.joints = {Joint::revolute("shoulder", {0, 0, 1}, {0, 0, 0}), Joint::revolute("elbow", {0, 0, 1}, {0.3, 0, 0}),
                Joint::prismatic("lift", {0, 0, -1})};
  arm.gamma << 0, 0, 0, 0.5, 0, 0.4;  // links of 0.3 m and 0.2 m along x, 0.4 m up
  const double a = M_PI / 6, b = M_PI / 3;
  const Eigen::Isometry3d T_base_flange = forwardKinematics(arm, Eigen::Vector3d(a, b, 0.1));
  const Eigen::Vector3d position(0.3 * std::cos(a) + 0.2 * std::cos(a + b), 0.3 * std::sin(a) + 0.2 * std::sin(a + b), 0.3);
  EXPECT_THAT(Eigen::Vector3d(T_base_flange.translation()), IsNear(position, kRounding));
  EXPECT_THAT(Eigen::Vector3d(T_base_flange.linear().col(0)), IsNear(Eigen::Vector3d(0, 1, 0), kRounding));
}

TEST(Arm, ChainHoldsTheMotionOfEachBody) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = randomArm(rng, "RPR");
  const Eigen::VectorXd q = uniformVector(rng, 3, 1.0);
  const ArmChain chain = forwardChain(arm, q);
  ASSERT_EQ(chain.P.size(), 4u);
  EXPECT_THAT(chain.P[0], PoseIsNear(Eigen::Isometry3d::Identity(), 0.0));
  // The axis of joint k stays where it is while joint k turns, so both neighbouring bodies carry its anchor to the same place.
  EXPECT_THAT(Eigen::Vector3d(chain.P[3] * arm.joints[2].anchor), IsNear(Eigen::Vector3d(chain.P[2] * arm.joints[2].anchor), kRounding));
  EXPECT_THAT(chain.T_base_flange, PoseIsNear(chain.P[3] * expSe3(arm.gamma), kRounding));
}

TEST(Arm, SpaceJacobianMatchesCentralDifferences) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = randomArm(rng, "RRPRRP");
  for (const double range : {0.0, 1e-9, 3.0}) {
    const Eigen::VectorXd q = uniformVector(rng, 6, range);
    const Matrix6Xd J = spaceJacobian(arm, forwardChain(arm, q));
    for (int k = 0; k < 6; ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(6, k);
      const Vector6d numeric = leftDifference(forwardKinematics(arm, q + step), forwardKinematics(arm, q - step));
      EXPECT_THAT(Vector6d(J.col(k)), IsNear(numeric, kDifferenceTolerance)) << "range " << range << ", joint " << k + 1;
    }
  }
}

TEST(Arm, TwistJacobianMatchesCentralDifferences) {
  Rng rng = test::rngOfThisTest();
  const Arm nominal = randomArm(rng, "RPRR");
  const int parameters = twistParameterCount(nominal);
  ASSERT_EQ(parameters, 14);
  for (const double size : {0.0, 1e-3, 1.5}) {
    const Eigen::VectorXd beta = uniformVector(rng, parameters, size);
    const Eigen::VectorXd q = uniformVector(rng, 4, 3.0);
    const Arm arm = displaceTwists(nominal, beta);
    const Matrix6Xd J = twistJacobian(nominal, beta, arm, forwardChain(arm, q), q);
    for (int k = 0; k < parameters; ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(parameters, k);
      const Vector6d numeric = leftDifference(forwardKinematics(displaceTwists(nominal, beta + step), q),
                                              forwardKinematics(displaceTwists(nominal, beta - step), q));
      EXPECT_THAT(Vector6d(J.col(k)), IsNear(numeric, kDifferenceTolerance))
          << "beta within " << size << ", " << twistParameterNames(nominal)[static_cast<std::size_t>(k)];
    }
  }
}

TEST(Arm, JointsThatDoNotMoveDoNotShowTheirTwists) {
  Rng rng = test::rngOfThisTest();
  const Arm nominal = randomArm(rng, "RPR");
  const Eigen::VectorXd beta = uniformVector(rng, twistParameterCount(nominal), 0.1);
  const Arm arm = displaceTwists(nominal, beta);
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(3);
  EXPECT_EQ(twistJacobian(nominal, beta, arm, forwardChain(arm, q), q).norm(), 0.0);
}

TEST(Arm, DisplacedTwistIsTheAdjointTransformOfTheNominalOne) {
  Rng rng = test::rngOfThisTest();
  const Arm nominal = randomArm(rng, "RP");
  const Eigen::VectorXd beta = uniformVector(rng, 6, 1.0);
  const Arm arm = displaceTwists(nominal, beta);
  const Vector6d eta_1 = twistBasis(nominal.joints[0]) * beta.head<4>();
  const Vector6d eta_2 = twistBasis(nominal.joints[1]) * beta.tail<2>();
  EXPECT_THAT(arm.joints[0].xi, IsNear(Vector6d(adjoint(expSe3(eta_1)) * nominal.joints[0].xi), kRounding));
  EXPECT_THAT(arm.joints[1].xi, IsNear(Vector6d(adjoint(expSe3(eta_2)) * nominal.joints[1].xi), kRounding));
  EXPECT_THAT(arm.joints[0].anchor, IsNear(Eigen::Vector3d(expSe3(eta_1) * nominal.joints[0].anchor), kRounding));
  EXPECT_EQ(arm.gamma, nominal.gamma);
}

TEST(Arm, JointConstraintsSurviveManyDisplacements) {
  Rng rng = test::rngOfThisTest();
  Arm arm = randomArm(rng, "RPRR");
  for (int step = 0; step < 200; ++step) arm = displaceTwists(arm, uniformVector(rng, twistParameterCount(arm), 0.2));
  for (const Joint& joint : arm.joints) {
    const Eigen::Vector3d w = joint.xi.head<3>();
    const Eigen::Vector3d v = joint.xi.tail<3>();
    EXPECT_NEAR(joint.axis().norm(), 1.0, 1e-12) << joint.name;
    EXPECT_NEAR(w.dot(v), 0.0, 1e-12) << joint.name;
    if (joint.type == JointType::kPrismatic) {
      EXPECT_EQ(w.norm(), 0.0) << joint.name;
    } else {
      EXPECT_THAT(Eigen::Vector3d(w.cross(joint.anchor) + v), IsNear(Eigen::Vector3d(0, 0, 0), 1e-12)) << joint.name;
    }
  }
}

TEST(Arm, BasisIsRightHandedAndTiltsAboutTheAnchor) {
  Rng rng = test::rngOfThisTest();
  std::vector<Joint> joints = randomArm(rng, "RRPP").joints;
  for (int k = 0; k < 3; ++k) {
    joints.push_back(Joint::revolute("along", Eigen::Vector3d::Unit(k), {0.1, 0.2, 0.3}));
    joints.push_back(Joint::revolute("against", -Eigen::Vector3d::Unit(k), {0.1, 0.2, 0.3}));
  }
  for (const Joint& joint : joints) {
    const Matrix6Xd B = twistBasis(joint);
    ASSERT_EQ(B.cols(), twistParameterCount(joint));
    const Eigen::Vector3d a = B.col(0).head<3>();
    const Eigen::Vector3d b = B.col(1).head<3>();
    Eigen::Matrix3d frame;
    frame << a, b, joint.axis();
    EXPECT_THAT(frame * frame.transpose(), IsNear(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), kRounding)) << joint.name;
    EXPECT_GT(frame.determinant(), 0.0) << joint.name;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d velocity_of_anchor = B.col(k).head<3>().cross(joint.anchor) + B.col(k).tail<3>();
      EXPECT_THAT(velocity_of_anchor, IsNear(Eigen::Vector3d(0, 0, 0), kRounding)) << joint.name;
    }
  }
  const Matrix6Xd B = twistBasis(Joint::revolute("z", {0, 0, 1}, {0, 0, 0}));
  Matrix6Xd x_and_y(6, 4);
  x_and_y << Vector6d::Unit(0), Vector6d::Unit(1), Vector6d::Unit(3), Vector6d::Unit(4);
  EXPECT_THAT(B, IsNear(x_and_y, 0.0));
}

TEST(Arm, BasisFollowsAnAxisThatTiltsALittle) {
  constexpr double kTilt = 0.01;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
    const Matrix6Xd straight = twistBasis(Joint::revolute("straight", axis, {0, 0, 0}));
    for (int direction = 0; direction < 12; ++direction) {
      const double angle = M_PI / 6.0 * direction;
      const Eigen::Vector3d across = Eigen::AngleAxisd(angle, axis) * Eigen::Vector3d::Unit((k + 1) % 3);
      const Matrix6Xd tilted = twistBasis(Joint::revolute("tilted", axis + kTilt * across, {0, 0, 0}));
      // Each column turns by the tilt, and by its square about the axis itself.
      EXPECT_LT((tilted - straight).colwise().norm().maxCoeff(), 1.1 * kTilt) << "axis " << k << ", direction " << direction;
    }
  }
}

TEST(Arm, AxisOffsetIsTheSizeOfSingleDisplacements) {
  Rng rng = test::rngOfThisTest();
  for (const double size : {1e-9, 1e-3, 0.5}) {
    for (const Joint& from : randomArm(rng, "RP").joints) {
      for (int k = 0; k < twistParameterCount(from); ++k) {
        Arm arm;
        arm.joints = {from};
        Joint to = displaceTwists(arm, size * Eigen::VectorXd::Unit(twistParameterCount(from), k)).joints[0];
        to.anchor += 0.7 * to.axis();  // another point of the same axis
        EXPECT_NEAR(axisOffset(from, to).tilt, k < 2 ? size : 0.0, 1e-15) << "column " << k;
        EXPECT_NEAR(axisOffset(from, to).shift, k < 2 ? 0.0 : size, 1e-15) << "column " << k;
      }
    }
  }
}

TEST(Arm, WhatTheBasisLeavesOutChangesNothing) {
  Rng rng = test::rngOfThisTest();
  const Joint joint = randomArm(rng, "R").joints[0];
  Vector6d turn_and_slide = 0.7 * joint.xi;
  turn_and_slide.tail<3>() += 0.3 * joint.axis();
  EXPECT_THAT(Vector6d(adjoint(expSe3(turn_and_slide)) * joint.xi), IsNear(joint.xi, kRounding));
}

// Gao 2013, eq. 27: of the 6 (n + 1) columns only 4 r + 2 p + 6 are independent, and the basis keeps just those.
TEST(Arm, StackedTwistJacobianAndGammaHaveFullRank) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = randomArm(rng, "RRPRRR");
  const int parameters = twistParameterCount(arm);
  ASSERT_EQ(parameters, 4 * 5 + 2 * 1);
  constexpr int kPoses = 20;
  Eigen::MatrixXd minimal(6 * kPoses, parameters + 6);
  Eigen::MatrixXd full(6 * kPoses, 6 * 7);
  const Eigen::VectorXd beta = Eigen::VectorXd::Zero(parameters);
  for (int pose = 0; pose < kPoses; ++pose) {
    const Eigen::VectorXd q = uniformVector(rng, 6, 2.0);
    const ArmChain chain = forwardChain(arm, q);
    const Matrix6d J_gamma = adjoint(chain.P.back()) * leftJacobianSe3(arm.gamma);
    minimal.middleRows<6>(6 * pose) << twistJacobian(arm, beta, arm, chain, q), J_gamma;
    for (std::size_t k = 0; k < 6; ++k) {
      full.block<6, 6>(6 * pose, 6 * static_cast<Eigen::Index>(k)) = adjoint(chain.P[k]) - adjoint(chain.P[k + 1]);
    }
    full.block<6, 6>(6 * pose, 36) = J_gamma;
  }
  EXPECT_EQ(rankOf(minimal), parameters + 6);
  EXPECT_EQ(rankOf(full), parameters + 6);
}

TEST(Arm, ParameterNamesFollowTheColumns) {
  Rng rng = test::rngOfThisTest();
  EXPECT_THAT(twistParameterNames(randomArm(rng, "RP")), testing::ElementsAre("joint 1 tilt a", "joint 1 tilt b", "joint 1 shift a",
                                                                              "joint 1 shift b", "joint 2 tilt a", "joint 2 tilt b"));
}

TEST(Arm, UnitAxesKeepTheirBits) {
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 100; ++trial) {
    const Joint joint = Joint::revolute("", uniformVector(rng, 3, 1.0), {0, 0, 0});
    EXPECT_EQ(Joint::revolute("", joint.axis(), {0, 0, 0}).axis(), joint.axis()) << "trial " << trial;
  }
}

TEST(Arm, RefusesSizesThatDoNotFitAndAxesWithoutDirection) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = randomArm(rng, "RR");
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(2);
  const Eigen::VectorXd beta = Eigen::VectorXd::Zero(8);
  EXPECT_THROW(forwardChain(arm, Eigen::VectorXd::Zero(3)), InvalidArgument);
  EXPECT_THROW(spaceJacobian(arm, ArmChain{}), InvalidArgument);
  EXPECT_THROW(displaceTwists(arm, q), InvalidArgument);
  EXPECT_THROW(twistJacobian(arm, q, arm, forwardChain(arm, q), q), InvalidArgument);
  EXPECT_THROW(twistJacobian(arm, beta, arm, ArmChain{}, q), InvalidArgument);
  EXPECT_THROW(Joint::revolute("still", {0, 0, 0}, {0, 0, 0}), InvalidArgument);
  EXPECT_THROW(Joint::prismatic("nan", {std::numeric_limits<double>::quiet_NaN(), 0, 0}), InvalidArgument);
}

// The inverse of a displacement, of every kind of joint and far beyond what arms are off by.
TEST(Arm, AnotherArmIsToldFromALooseOne) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = test::randomArm(rng, "RRPRRR");
  // Ten times what loose arms have.
  Eigen::VectorXd loose(twistParameterCount(arm));
  for (Eigen::Index k = 0; k < loose.size(); ++k) loose(k) = 0.02 * rng.normal();
  EXPECT_EQ(differenceOfArms(arm, displaceTwists(arm, loose)), "");
  Arm shorter = arm;
  shorter.joints.pop_back();
  EXPECT_EQ(differenceOfArms(arm, shorter), "5 joints, expected 6");
  Arm turning = arm;
  std::swap(turning.joints[2], turning.joints[3]);
  EXPECT_EQ(differenceOfArms(arm, turning), "joint 3 is revolute, expected prismatic");
  Arm tilted = arm;
  const Eigen::Vector3d across = arm.joints[4].axis().unitOrthogonal();
  tilted.joints[4] = Joint::revolute("tilted", Eigen::AngleAxisd(1.0, across) * arm.joints[4].axis(), arm.joints[4].anchor);
  EXPECT_EQ(differenceOfArms(arm, tilted), "axis 5 is 57 degrees and 0 mm from where it should be");
  Arm moved = arm;
  moved.joints[4] = Joint::revolute("moved", arm.joints[4].axis(), arm.joints[4].anchor + 0.5 * across);
  EXPECT_EQ(differenceOfArms(arm, moved), "axis 5 is 0 degrees and 500 mm from where it should be");
}

TEST(TwistDisplacement, GivesBackWhatAnAxisWasMovedBy) {
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 20; ++trial) {
    const Arm nominal = test::randomArm(rng, "RPRRPR");
    const Eigen::VectorXd beta = test::uniformVector(rng, twistParameterCount(nominal), 0.2);
    EXPECT_THAT(twistDisplacement(nominal, displaceTwists(nominal, beta)), test::IsNear(beta, 1e-12)) << "trial " << trial;
  }
}

TEST(TwistDisplacement, OfAnotherArmIsAnError) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = test::randomArm(rng, "RPR");
  EXPECT_THROW(twistDisplacement(arm, test::randomArm(rng, "RP")), InvalidArgument);
  EXPECT_THROW(twistDisplacement(arm, test::randomArm(rng, "RRR")), InvalidArgument);
}

}  // namespace
}  // namespace poecal
