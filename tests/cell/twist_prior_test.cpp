// The prior of an arm's geometry against draws of the parts that it is made of, and against arms with one thing wrong.
#include "poecal/cell/twist_prior.hpp"

#include <gmock/gmock.h>

#include "poecal/geometry/se3.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

constexpr double kPosition = 1e-3, kRotation = 3e-3, kZero = 0.02;

/// Three joints across each other, as drawn.
Arm threeJoints() {
  Arm arm;
  arm.joints = {Joint::revolute("a", Eigen::Vector3d::UnitZ(), {0.0, 0.0, 0.0}),
                Joint::revolute("b", Eigen::Vector3d::UnitY(), {0.1, 0.0, 0.4}),
                Joint::revolute("c", Eigen::Vector3d::UnitX(), {0.3, 0.0, 0.5})};
  arm.gamma << 0.0, 0.0, 0.0, 0.6, 0.0, 0.5;
  return arm;
}

/// beta of joint j of an arm for a motion `l` of its surrounding, by solving Ad(exp(B beta)) xi = Ad(exp(l)) xi to first order.
Eigen::VectorXd moved(const Joint& joint, const Vector6d& l) {
  const Matrix6Xd B = twistBasis(joint);
  return (adjointOfTwist(joint.xi) * B).completeOrthogonalDecomposition().solve(adjointOfTwist(joint.xi) * l);
}

/// beta of an arm of which the link behind joint k moved by `l` (base frame): all axes after it.
Eigen::VectorXd linkMoved(const Arm& arm, std::size_t k, const Vector6d& l) {
  Eigen::VectorXd beta = Eigen::VectorXd::Zero(twistParameterCount(arm));
  int row = 0;
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    const int size = twistParameterCount(arm.joints[j]);
    if (j > k) beta.segment(row, size) = moved(arm.joints[j], l);
    row += size;
  }
  return beta;
}

Vector6d aboutAnchor(const Joint& joint, const Vector6d& l) {
  Vector6d shift = Vector6d::Zero();
  shift.tail<3>() = joint.anchor;
  return adjoint(expSe3(shift)) * l;
}

TEST(TwistPrior, IsTheCovarianceOfItsParts) {
  const Arm arm = threeJoints();
  const TwistPrior prior(arm, kPosition, kRotation);
  Rng rng = test::rngOfThisTest();
  constexpr int kDraws = 20000;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(12, 12);
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd beta(12);
    for (int k = 0; k < 12; ++k) beta(k) = std::sqrt(0.5) * (k % 4 < 2 ? kRotation : kPosition) * rng.normal();
    for (std::size_t k = 0; k < 2; ++k) {
      Vector6d link;
      for (int i = 0; i < 6; ++i) link(i) = std::sqrt(0.5) * (i < 3 ? kRotation : kPosition) * rng.normal();
      beta += linkMoved(arm, k, aboutAnchor(arm.joints[k], link)) + linkMoved(arm, k, kZero * rng.normal() * arm.joints[k].xi);
    }
    covariance += beta * beta.transpose() / kDraws;
  }
  // Whitened by the prior, the covariance of the draws is 1 up to the scatter of a variance from so many draws, five of its deviations.
  const Eigen::MatrixXd root = prior.precision.llt().matrixU();
  const Eigen::MatrixXd whitened = root * covariance * root.transpose();
  EXPECT_LT((whitened - Eigen::MatrixXd::Identity(12, 12)).cwiseAbs().maxCoeff(), 5.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(prior.log_determinant, std::log(prior.precision.determinant()), 1e-9);
}

TEST(TwistPrior, AZeroThatIsOffIsToldAsThat) {
  const Arm arm = threeJoints();
  const TwistPrior prior(arm, kPosition, kRotation);
  constexpr double kOff = 0.0873;  // 5 degrees
  const std::vector<JointDeviation> told = prior.deviations(linkMoved(arm, 1, kOff * arm.joints[1].xi));
  // The prior draws a little of it to the links: theirs is 3 mrad of 20.
  EXPECT_NEAR(told[1].zero, kOff, 0.05 * kOff);
  EXPECT_LT(std::abs(told[0].zero), 0.05 * kOff);
  EXPECT_LT(told[2].tilt, 0.05 * kOff);
}

// A turn of the base about the first axis does what that joint's zero does: where the base may stand anywhere, it is none.
TEST(TwistPrior, TheFirstZeroIsOneWhereSomethingIsKnownOfTheBase) {
  const Arm arm = threeJoints();
  const TwistPrior known(arm, kPosition, kRotation), open(arm, kPosition, kRotation, false);
  const Eigen::VectorXd turned = linkMoved(arm, 0, arm.joints[0].xi);
  const Eigen::MatrixXd less = known.precision.inverse() - open.precision.inverse();
  EXPECT_LT((less - kZero * kZero * turned * turned.transpose()).cwiseAbs().maxCoeff(), 1e-6 * kZero * kZero);
  EXPECT_EQ(open.deviations(0.05 * turned)[0].zero, 0.0);
  EXPECT_GT(known.deviations(0.05 * turned)[0].zero, 0.04);
}

TEST(TwistPrior, ATiltedAxisIsToldAsThat) {
  const Arm arm = threeJoints();
  const TwistPrior prior(arm, kPosition, kRotation);
  constexpr double kTilt = 0.26;  // 15 degrees
  Eigen::VectorXd beta = Eigen::VectorXd::Zero(12);
  beta(0) = kTilt;  // of the first joint, whose axis nothing but itself moves
  const std::vector<JointDeviation> told = prior.deviations(beta);
  EXPECT_NEAR(told[0].tilt, kTilt, 1e-9);
  for (const std::size_t other : {1u, 2u}) EXPECT_LT(told[other].tilt, 1e-9) << other;
}

TEST(TwistPrior, TheFactorOfDrawnArmsIsFound) {
  const Arm arm = threeJoints();
  const TwistPrior prior(arm, kPosition, kRotation);
  const Eigen::MatrixXd root = prior.precision.llt().matrixU();
  Rng rng = test::rngOfThisTest();
  // Known exactly, the factor is the root of a mean of twelve squares: five of its deviations.
  constexpr double kFactor = 6.0, kScatter = 5.0 / std::sqrt(2.0 * 12.0);
  const Eigen::VectorXd beta = kFactor * root.triangularView<Eigen::Upper>().solve(test::normalVector(rng, 12));
  const double found = updatedTolerance(prior, beta, Eigen::MatrixXd::Zero(12, 12), 1.0);
  EXPECT_NEAR(found / kFactor, 1.0, kScatter);
  EXPECT_EQ(updatedTolerance(prior, Eigen::VectorXd::Zero(12), Eigen::MatrixXd::Zero(12, 12), 1.0), 1.0) << "never below 1";
}

}  // namespace
}  // namespace poecal
