#include "poecal/robot/gravity.hpp"

#include <gmock/gmock.h>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "poecal/core/error.hpp"
#include "support/arms.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::IsNear;

const Eigen::Vector3d kGravity(0.7, -1.1, -9.7);
/// Sums of a few products of numbers up to 1e2.
constexpr double kRounding = 1e-12;

Arm armWithMasses(Rng& rng, const std::string& joint_types) {
  Arm arm = test::randomArm(rng, joint_types);
  for (std::size_t k = 0; k < arm.joints.size(); ++k) arm.links.push_back({rng.uniform(0.5, 5.0), test::uniformVector(rng, 3, 0.5)});
  return arm;
}

/// U = -sum m g . c(q), the payload's too [J].
double potentialEnergy(const Arm& arm, const Eigen::VectorXd& q, double payload) {
  const ArmChain chain = forwardChain(arm, q);
  double energy = -payload * kGravity.dot(chain.T_base_flange.translation());
  for (std::size_t k = 0; k < arm.links.size(); ++k) energy -= arm.links[k].mass * kGravity.dot(chain.P[k + 1] * arm.links[k].com);
  return energy;
}

TEST(GravityLoad, TorqueIsTheFallOfPotentialEnergy) {
  // Step 1e-5: truncation of 1e-10 times third derivatives of some 1e2 J, rounding 1e-14 * 1e2 / 1e-5.
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-7;
  Rng rng = test::rngOfThisTest();
  for (const double payload : {0.0, 2.5}) {
    const Arm arm = armWithMasses(rng, "RRPRR");
    const Eigen::VectorXd q = test::uniformVector(rng, 5, 1.0);
    const GravityLoad load = gravityLoad(arm, forwardChain(arm, q), kGravity, payload);
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(5, k);
      const double fall = (potentialEnergy(arm, q - step, payload) - potentialEnergy(arm, q + step, payload)) / (2.0 * kStep);
      EXPECT_NEAR(load.torque(k), fall, kTolerance) << "joint " << k + 1;
    }
  }
}

TEST(GravityLoad, CarriedIsTheSumOverTheBodiesBeyond) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = armWithMasses(rng, "RRR");
  const ArmChain chain = forwardChain(arm, test::uniformVector(rng, 3, 1.0));
  constexpr double kPayload = 1.5;
  const GravityLoad load = gravityLoad(arm, chain, kGravity, kPayload);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d anchor_base = chain.P[k] * arm.joints[k].anchor;
    Eigen::Vector3d moment = (chain.T_base_flange.translation() - anchor_base).cross(kPayload * kGravity), force = kPayload * kGravity;
    for (std::size_t j = k; j < 3; ++j) {
      moment += (chain.P[j + 1] * arm.links[j].com - anchor_base).cross(arm.links[j].mass * kGravity);
      force += arm.links[j].mass * kGravity;
    }
    const auto column = static_cast<Eigen::Index>(k);
    EXPECT_THAT(load.carried.col(column).head<3>(), IsNear(moment, kRounding));
    EXPECT_THAT(load.carried.col(column).tail<3>(), IsNear(force, kRounding));
    // A revolute joint's torque is the component of the moment along its axis.
    EXPECT_NEAR(load.torque(column), moment.dot(chain.P[k].linear() * arm.joints[k].axis()), kRounding);
  }
}

TEST(GravityLoad, HorizontalArmByHand) {
  // 2 kg, 0.5 m out along x, turning about y: gravity along -z pulls it down, which is a positive turn about y.
  Arm arm;
  arm.joints = {Joint::revolute("nod", Eigen::Vector3d::UnitY(), Eigen::Vector3d::Zero())};
  arm.links = {{2.0, Eigen::Vector3d(0.5, 0, 0)}};
  const GravityLoad load = gravityLoad(arm, forwardChain(arm, Eigen::VectorXd::Zero(1)), Eigen::Vector3d(0, 0, -10));
  EXPECT_NEAR(load.torque(0), 10.0, kRounding);
}

TEST(GravityRegressor, TimesTheMassesOfTheBodiesBeyondIsWhatAJointCarries) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = armWithMasses(rng, "RPRR");
  const ArmChain chain = forwardChain(arm, test::uniformVector(rng, 4, 1.0));
  Eigen::VectorXd masses(16);
  for (int k = 0; k < 4; ++k) {
    const LinkMass& link = arm.links[static_cast<std::size_t>(k)];
    masses.segment<4>(4 * k) << link.mass, link.mass * link.com;
  }
  const GravityLoad load = gravityLoad(arm, chain, kGravity);
  const Matrix6Xd W = gravityRegressor(arm, chain, kGravity);
  EXPECT_THAT(W * masses, IsNear(load.base, kRounding));
  const Matrix6Xd J = spaceJacobian(arm, chain);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const Vector6d beyond = W.rightCols(16 - 4 * k) * masses.tail(16 - 4 * k);
    EXPECT_NEAR(J.col(k).dot(beyond), load.torque(k), kRounding);
    EXPECT_THAT(beyond.tail<3>(), IsNear(load.carried.col(k).tail<3>(), kRounding));
  }
}

TEST(GravityLoad, ArmWithoutMassesIsAnError) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = test::randomArm(rng, "RR");
  EXPECT_THROW(gravityLoad(arm, forwardChain(arm, Eigen::VectorXd::Zero(2)), kGravity), InvalidArgument);
}

/// KDL's inverse dynamics of an arm whose bodies are points of mass, built joint by joint from axes and points.
Eigen::VectorXd kdlHoldingTorques(const Arm& arm, const Eigen::VectorXd& q) {
  const auto vector = [](const Eigen::Vector3d& v) { return KDL::Vector(v.x(), v.y(), v.z()); };
  KDL::Chain chain;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const Joint& joint = arm.joints[k];
    const bool revolute = joint.type == JointType::kRevolute;
    // All segments' frames coincide with base at q = 0, as ours do.
    const KDL::Joint kdl_joint(joint.name, vector(joint.anchor), vector(joint.axis()),
                               revolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis);
    const KDL::RigidBodyInertia inertia(arm.links[k].mass, vector(arm.links[k].com));
    chain.addSegment(KDL::Segment(joint.name, kdl_joint, KDL::Frame::Identity(), inertia));
  }
  KDL::ChainIdSolver_RNE solver(chain, vector(kGravity));
  const unsigned n = chain.getNrOfJoints();
  KDL::JntArray positions(n), velocities(n), accelerations(n), torques(n);
  positions.data = q;
  solver.CartToJnt(positions, velocities, accelerations, KDL::Wrenches(n, KDL::Wrench::Zero()), torques);
  return torques.data;
}

TEST(GravityLoad, HoldsAgainstKdl) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = armWithMasses(rng, "RRPRRR");
  const Eigen::VectorXd q = test::uniformVector(rng, 6, 1.0);
  const Eigen::VectorXd holding = kdlHoldingTorques(arm, q);
  EXPECT_THAT(gravityLoad(arm, forwardChain(arm, q), kGravity).torque, IsNear(Eigen::VectorXd(-holding), kRounding * 10.0));
}

}  // namespace
}  // namespace poecal
