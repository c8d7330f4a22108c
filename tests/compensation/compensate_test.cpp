// The joints to command, where the truth is known.
#include "poecal/compensation/compensate.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "effects/rich_cell.hpp"
#include "poecal/cell/ports.hpp"
#include "poecal/core/error.hpp"
#include "support/arms.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr double kPromised = 1e-9;  // [m], [rad]: what compensate.hpp says

const Eigen::Vector3d kGravity(0.5, -0.3, -9.8);

SampleTable tableOf(const std::vector<Sample>& samples) {
  SampleTable table;
  table.samples = samples;
  return table;
}

/// Poses that an arm has at the samples' joints.
SampleTable posesOf(const Arm& arm, const std::vector<Sample>& samples) {
  SampleTable table = tableOf(samples);
  for (Sample& sample : table.samples) sample.T_base_flange = forwardKinematics(arm, sample.q);
  return table;
}

/// That at these joints alone.
SampleTable poseAt(const Arm& arm, const Eigen::VectorXd& q) {
  Sample sample;
  sample.q = q;
  return posesOf(arm, {sample});
}

/// An arm whose twists are off by up to `size`.
Arm armNear(const Arm& arm, double size, Rng& rng) { return displaceTwists(arm, test::uniformVector(rng, twistParameterCount(arm), size)); }

/// A flaw of every kind that moves the flange, at sizes far above those of real arms.
std::vector<AppliedEffect> manyEffects(const test::RichCell& rich) {
  return {test::effectOf(rich, "joint_gain", "joint:1", {{"gain", 2e-3}}),
          test::effectOf(rich, "joint_eccentricity", "joint:2", {{"sine", 2e-3}, {"cosine", -1e-3}}),
          test::effectOf(rich, "joint_harmonic", "joint:3", {{"order", 6.0}, {"sine", 5e-4}, {"cosine", 1e-3}}),
          test::effectOf(rich, "joint_coupling", "joint:6", {{"source", 5.0}, {"ratio", 4e-3}}),
          test::effectOf(rich, "joint_compliance", "joint:2", {{"compliance", 4e-5}}),
          test::effectOf(rich, "joint_backlash", "joint:5", {{"half_gap", 6e-4}}),
          test::effectOf(rich, "joint_drift", "joint:4", {{"rate", 1e-3}, {"reference", 20.0}}, "temperature"),
          test::effectOf(rich, "axis_wobble", "joint:3", {{"sine_a", 5e-4}, {"cosine_b", 4e-4}}),
          test::effectOf(rich, "link_bending", "link:2", {{"compliance", 2e-5}}),
          test::effectOf(rich, "base_compliance", "base", {{"compliance", 1e-5}})};
}

/// What the true arm does with a command, by the simulator's own path.
Eigen::Isometry3d trulyReached(const test::RichCell& rich, const std::vector<AppliedEffect>& effects, std::vector<Sample> samples,
                               std::size_t k, const Eigen::VectorXd& q) {
  samples[k].q = q;
  return disturbedFlange(rich.cell, samples[k], disturbancesOf(effects, rich.cell, rich.target, kGravity, samples)[k]);
}

TEST(Compensate, ATrueArmWithEffectsGoesWhereTheNominalOneWould) {
  Rng rng(3);
  const test::RichCell rich = test::richCell(rng);
  const Arm& actual = *rich.cell.arm;
  const Arm nominal = armNear(actual, 2e-3, rng);
  const std::vector<AppliedEffect> effects = manyEffects(rich);
  const SampleTable wanted = posesOf(nominal, rich.samples);
  const std::vector<JointCommand> commands = compensate({.arm = actual, .effects = effects, .gravity = kGravity}, wanted);
  ASSERT_EQ(commands.size(), wanted.samples.size());
  for (std::size_t k = 0; k < commands.size(); ++k) {
    EXPECT_THAT(commands[k].why_not, IsEmpty());
    const Eigen::Isometry3d T = trulyReached(rich, effects, rich.samples, k, commands[k].q);
    EXPECT_THAT(T, test::PoseIsNear(*wanted.samples[k].T_base_flange, kPromised)) << k;
    EXPECT_THAT(commands[k].T_base_flange, test::PoseIsNear(T, 1e-12));
    EXPECT_LT(commands[k].position_error, kPromised);
    EXPECT_LT(commands[k].rotation_error, kPromised);
    // Uncompensated, the same arm is millimetres off: the test would see a command that corrects nothing.
    EXPECT_GT(
        (trulyReached(rich, effects, rich.samples, k, rich.samples[k].q).translation() - wanted.samples[k].T_base_flange->translation())
            .norm(),
        1e-3);
  }
}

TEST(Compensate, ReachedPosesAreThoseOfTheSimulator) {
  Rng rng(4);
  const test::RichCell rich = test::richCell(rng);
  const std::vector<AppliedEffect> effects = manyEffects(rich);
  const auto poses = reachedPoses({.arm = *rich.cell.arm, .effects = effects, .gravity = kGravity}, tableOf(rich.samples));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_THAT(poses[k], test::PoseIsNear(trulyReached(rich, effects, rich.samples, k, rich.samples[k].q), 1e-13));
  }
}

TEST(Compensate, WhatDisturbsTheMeasurementAloneMovesNoCommand) {
  Rng rng(5);
  const test::RichCell rich = test::richCell(rng);
  const std::vector<AppliedEffect> effects{test::effectOf(rich, "camera_drift", "camera.mount", {{"tx", 0.1}}),
                                           test::effectOf(rich, "target_scale", "target.shape", {{"scale", 0.1}}),
                                           test::effectOf(rich, "time_offset", "timing", {{"offset", 0.1}}),
                                           test::effectOf(rich, "joint_scatter", "joint:2", {{"sigma", 0.1}})};
  for (const AppliedEffect& applied : effects) EXPECT_FALSE(movesFlange(applied.effect)) << applied.effect.name();
  const SampleTable wanted = posesOf(*rich.cell.arm, rich.samples);
  for (const JointCommand& command : compensate({.arm = *rich.cell.arm, .effects = effects}, wanted)) {
    EXPECT_THAT(command.q, test::IsNear(command.start, 1e-12));
  }
}

TEST(Compensate, WithoutStartsThePosesAreFoundAndFollowEachOther) {
  Rng rng(6);
  Arm arm = test::randomArm(rng, "RRRRRR");
  for (Joint& joint : arm.joints) joint.limits = JointLimits{-2.9, 2.9};
  SampleTable wanted;
  Eigen::VectorXd q = test::uniformVector(rng, 6, 1.5);
  for (int k = 0; k < 6; ++k) {
    Sample sample;
    sample.T_base_flange = forwardKinematics(arm, q);
    wanted.samples.push_back(sample);
    q += test::uniformVector(rng, 6, 0.02);
  }
  const std::vector<JointCommand> commands = compensate({.arm = arm}, wanted);
  for (std::size_t k = 0; k < commands.size(); ++k) {
    ASSERT_THAT(commands[k].why_not, IsEmpty());
    EXPECT_THAT(forwardKinematics(arm, commands[k].q), test::PoseIsNear(*wanted.samples[k].T_base_flange, kPromised));
    // One branch of the solutions is kept: joints that moved by 0.02 do not turn over.
    if (k == 0) continue;
    EXPECT_LT((commands[k].q - commands[k - 1].q).cwiseAbs().maxCoeff(), 0.3) << k;
  }
}

TEST(Compensate, ARedundantArmStaysNearItsStart) {
  Rng rng(7);
  const Arm actual = test::randomArm(rng, "RRRRRRR");
  const Arm nominal = armNear(actual, 1e-3, rng);
  const SampleTable wanted = poseAt(nominal, test::uniformVector(rng, 7, 1.0));
  const Sample& sample = wanted.samples.front();
  const JointCommand command = compensate({.arm = actual}, wanted).front();
  EXPECT_THAT(forwardKinematics(actual, command.q), test::PoseIsNear(*sample.T_base_flange, kPromised));
  // The least motion has no part along the joints' own motion that leaves the flange where it is, to the first order in its size.
  const Matrix6Xd J = spaceJacobian(actual, forwardChain(actual, command.q));
  const Eigen::VectorXd idle = J.fullPivLu().kernel().col(0).normalized();
  const Eigen::VectorXd moved = command.q - sample.q;
  EXPECT_LT(std::abs(idle.dot(moved)), 10.0 * moved.squaredNorm());
}

TEST(Compensate, LimitsAreKeptAndTheReasonNamesTheJoint) {
  Rng rng(8);
  Arm arm = test::randomArm(rng, "RRRRRR");
  arm.joints[2].name = "elbow";
  SampleTable wanted = poseAt(arm, test::uniformVector(rng, 6, 0.8));
  double& elbow = wanted.samples.front().q(2);
  arm.joints[2].limits = JointLimits{elbow - 1.0, elbow - 0.1};
  elbow -= 0.2;
  const JointCommand command = compensate({.arm = arm}, wanted).front();
  EXPECT_THAT(command.why_not, StartsWith("q3 (elbow) would have to be "));
  EXPECT_THAT(command.why_not, HasSubstr("beyond its limits"));
  EXPECT_LE(command.q(2), arm.joints[2].limits->upper);
  EXPECT_GT(command.position_error, kPromised);
}

TEST(Compensate, APoseOutOfReachSaysHowFarItIs) {
  Rng rng(9);
  const Arm arm = test::randomArm(rng, "RRRRRR", 0.3);
  SampleTable wanted = poseAt(arm, Eigen::VectorXd::Zero(6));
  wanted.samples.front().line = 7;
  wanted.samples.front().T_base_flange->translation().x() = 50.0;
  const std::vector<JointCommand> commands = compensate({.arm = arm}, wanted);
  EXPECT_THAT(commands.front().why_not, HasSubstr("no joints were found that reach it"));
  EXPECT_GT(commands.front().position_error, 40.0);
  EXPECT_THAT(commandsCsv(wanted, commands), StartsWith("line,q1,q2,q3,q4,q5,q6,x,y,z,qx,qy,qz,qw,position_error,rotation_error\n"));
  EXPECT_THAT(commandsCsv(wanted, commands), ::testing::Not(HasSubstr("\n7,")));
}

TEST(Compensate, AnArmOfFourJointsComesAsNearAsItCan) {
  Rng rng(10);
  const Arm actual = test::randomArm(rng, "RRRR");
  const Arm nominal = armNear(actual, 1e-3, rng);
  const SampleTable wanted = poseAt(nominal, test::uniformVector(rng, 4, 0.8));
  const Sample& sample = wanted.samples.front();
  const JointCommand command = compensate({.arm = actual}, wanted).front();
  EXPECT_THAT(command.why_not, IsEmpty());
  const auto missed = [&](const Eigen::VectorXd& q) {
    const Eigen::Isometry3d T = forwardKinematics(actual, q);
    return std::hypot((T.translation() - sample.T_base_flange->translation()).norm(),
                      0.1 * rotationAngle(T.linear().transpose() * sample.T_base_flange->linear()));
  };
  // No small motion of any joint comes nearer.
  for (Eigen::Index k = 0; k < 4; ++k) {
    for (const double step : {-1e-5, 1e-5}) EXPECT_LT(missed(command.q), missed(command.q + step * Eigen::VectorXd::Unit(4, k)));
  }
  EXPECT_LT(missed(command.q), missed(sample.q));
}

TEST(Compensate, SidesComeFromTheOrderAndTimesDoNot) {
  Rng rng(11);
  test::RichCell rich = test::richCell(rng);
  for (Sample& sample : rich.samples) {
    sample.dir.resize(0);
    sample.stamp.reset();
  }
  const SampleTable wanted = posesOf(*rich.cell.arm, rich.samples);
  constexpr double kHalfGap = 5e-4;
  const auto commands =
      compensate({.arm = *rich.cell.arm, .effects = {test::effectOf(rich, "joint_backlash", "joint:1", {{"half_gap", kHalfGap}})}}, wanted);
  for (std::size_t k = 1; k < commands.size(); ++k) {
    const double side = rich.samples[k].q(0) > rich.samples[k - 1].q(0) ? 1.0 : -1.0;
    EXPECT_NEAR(std::abs(commands[k].q(0) - rich.samples[k].q(0)), kHalfGap, 1e-9);
    EXPECT_EQ((commands[k].q(0) > rich.samples[k].q(0)),
              (commands[1].q(0) > rich.samples[1].q(0)) == (side == (rich.samples[1].q(0) > rich.samples[0].q(0) ? 1.0 : -1.0)));
  }
  const RealArm drifting{.arm = *rich.cell.arm, .effects = {test::effectOf(rich, "joint_drift", "joint:1", {{"rate", 1e-3}}, "stamp")}};
  EXPECT_THAT([&] { compensate(drifting, wanted); },
              ThrowsMessage<InsufficientData>(HasSubstr("joint_drift at joint:1 cannot be computed: no stamp column")));
}

TEST(Compensate, EachRowIsToldAndMayStopIt) {
  Rng rng(13);
  const RealArm arm{.arm = test::randomArm(rng, "RRRRRR")};
  std::vector<Sample> samples(5);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Eigen::VectorXd q = test::uniformVector(rng, 6, 1.0);
    samples[k].T_base_flange = forwardKinematics(arm.arm, q);
    if (k > 1) samples[k].q = q;
  }
  std::vector<std::pair<std::string, std::size_t>> left;
  const auto listen = [&left](const std::string& label, std::size_t done, std::size_t total) { left.emplace_back(label, total - done); };
  const std::vector<JointCommand> told = compensate(arm, tableOf(samples), nullptr, listen);
  const std::string begin = "joints to begin from", each = "joints for each pose";
  EXPECT_THAT(left, ::testing::ElementsAre(std::pair(begin, 1u), std::pair(begin, 0u), std::pair(each, 4u), std::pair(each, 3u),
                                           std::pair(each, 2u), std::pair(each, 1u), std::pair(each, 0u)));
  EXPECT_EQ(commandsCsv(tableOf(samples), told), commandsCsv(tableOf(samples), compensate(arm, tableOf(samples))));
  const auto enough = [](const std::string& label, std::size_t done, std::size_t) {
    if (label == "joints for each pose" && done == 2) throw std::runtime_error("enough");
  };
  EXPECT_THAT([&] { compensate(arm, tableOf(samples), nullptr, enough); }, ThrowsMessage<std::runtime_error>("enough"));
}

TEST(Compensate, ASampleWithoutAPoseIsRefused) {
  Rng rng(12);
  EXPECT_THAT([&] { compensate({.arm = test::randomArm(rng, "RRRRRR")}, tableOf({Sample{}})); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no pose to reach")));
}

}  // namespace
}  // namespace poecal
