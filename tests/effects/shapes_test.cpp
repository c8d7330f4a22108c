// What single effects do, against what is known of them.
#include <gmock/gmock.h>

#include "effects/rich_cell.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::effectOf;
using test::IsNear;
using test::PoseIsNear;

constexpr double kRounding = 1e-12;

class Shapes : public ::testing::Test {
 protected:
  Shapes() : rng_(test::rngOfThisTest()), rich_(test::richCell(rng_)) {}

  Disturbance disturbance(const AppliedEffect& effect, std::size_t sample) const { return disturbanceOf({effect}, rich_.context(sample)); }
  std::vector<std::optional<Eigen::Vector2d>> corners(const AppliedEffect& effect, std::size_t sample) const {
    return disturbedCorners(rich_.cell, rich_.samples[sample], rich_.target.points, disturbance(effect, sample));
  }

  Rng rng_;
  test::RichCell rich_;
};

TEST_F(Shapes, GainIsAnotherReading) {
  const Disturbance gain = disturbance(effectOf(rich_, "joint_gain", "joint:3", {{"gain", 2e-3}}), 1);
  Sample read_right = rich_.samples[1];
  read_right.q(2) *= 1.002;
  EXPECT_THAT(disturbedFlange(rich_.cell, rich_.samples[1], gain), PoseIsNear(rich_.cell.baseFlange(read_right), kRounding));
}

TEST_F(Shapes, JointsOwnNumbersDriveIt) {
  const Sample& sample = rich_.samples[1];
  const SampleContext context = rich_.context(1);
  EXPECT_NEAR(disturbance(effectOf(rich_, "joint_backlash", "joint:2", {{"half_gap", 3e-4}}), 1).joints(1), 3e-4 * sample.dir(1), 0.0);
  EXPECT_NEAR(disturbance(effectOf(rich_, "joint_compliance", "joint:2", {{"compliance", 2e-5}}), 1).joints(1), 2e-5 * context.torque(1),
              kRounding);
  EXPECT_NEAR(disturbance(effectOf(rich_, "joint_coupling", "joint:2", {{"source", 5.0}, {"ratio", 1e-2}}), 1).joints(1),
              1e-2 * sample.q(4), kRounding);
  EXPECT_NEAR(disturbance(effectOf(rich_, "joint_eccentricity", "joint:2", {{"sine", 3e-4}, {"cosine", -4e-4}}), 1).joints(1),
              5e-4 * std::sin(sample.q(1) + std::atan2(-4.0, 3.0)), kRounding);
  EXPECT_NEAR(disturbance(effectOf(rich_, "joint_harmonic", "joint:2", {{"order", 7.0}, {"sine", 3e-4}}), 1).joints(1),
              3e-4 * std::sin(7.0 * sample.q(1)), kRounding);
}

TEST_F(Shapes, ComplianceIsGravitysWork) {
  // A joint that yields lets the arm's masses sink: the work of gravity over the yield is positive.
  for (int k = 1; k <= 6; ++k) {
    const SampleContext context = rich_.context(0);
    const Disturbance yield = disturbance(effectOf(rich_, "joint_compliance", "joint:" + std::to_string(k), {{"compliance", 1e-5}}), 0);
    EXPECT_GT(yield.joints.dot(context.torque), 0.0) << "joint " << k;
  }
}

TEST_F(Shapes, HysteresisIsFrictionOverStiffness) {
  // Second formula: a spring of 2e4 N m/rad that friction of 5 % of the load keeps from unwinding; it stops short on either side.
  constexpr double kStiffness = 2e4, kFriction = 0.05;
  const AppliedEffect effect = effectOf(rich_, "joint_hysteresis", "joint:2", {{"lag", kFriction / kStiffness}});
  const double held = kFriction * std::abs(rich_.context(1).torque(1)) / kStiffness;
  for (const double side : {-1.0, 0.0, 1.0}) {
    rich_.samples[1].dir(1) = side;
    EXPECT_NEAR(disturbance(effect, 1).joints(1), -side * held, kRounding);
  }
  rich_.samples[1].payload = 30.0;
  EXPECT_NE(disturbance(effect, 1).joints(1), -held) << "a payload is a load";
}

TEST_F(Shapes, SlipsBeginAtTheirTime) {
  const AppliedEffect joint = effectOf(rich_, "joint_slip", "joint:1", {{"time", 2000.0}, {"offset", 1e-3}});
  const AppliedEffect camera = effectOf(rich_, "camera_slip", "camera.mount", {{"time", 2000.0}, {"ry", 1e-3}});
  EXPECT_EQ(disturbance(joint, 1).joints(0), 0.0);
  EXPECT_EQ(disturbance(joint, 2).joints(0), 1e-3);
  EXPECT_EQ(disturbance(camera, 1).mount.norm(), 0.0);
  EXPECT_EQ(disturbance(camera, 2).mount(1), 1e-3);
}

TEST_F(Shapes, DriftsCountHoursOrKelvin) {
  // Sample 3 is 1.5 h and 6 K after the first.
  EXPECT_NEAR(disturbance(effectOf(rich_, "joint_drift", "joint:1", {{"rate", 2e-3}}), 3).joints(0), 3e-3, kRounding);
  EXPECT_NEAR(disturbance(effectOf(rich_, "joint_drift", "joint:1", {{"rate", 2e-3}}, "temperature"), 3).joints(0), 12e-3, kRounding);
  EXPECT_NEAR(disturbance(effectOf(rich_, "camera_drift", "camera.mount", {{"tz", 1e-3}}, "stamp"), 3).mount(5), 1.5e-3, kRounding);
  EXPECT_NEAR(disturbance(effectOf(rich_, "focal_drift", "camera.lens", {{"rate", 1e-3}}, "temperature"), 3).intrinsics(1), 6e-3 * 1110.0,
              1e-10);
}

TEST_F(Shapes, WobbleTiltsTheAxisAndLeavesItsAnchor) {
  // Second formula: the arm whose joint 2 has another axis at this reading, all that it carries turned along with it.
  constexpr double kTilt = 1e-3;
  const Disturbance wobble = disturbance(effectOf(rich_, "axis_wobble", "joint:2", {{"sine_a", kTilt}}), 1);
  Arm tilted = *rich_.cell.arm;
  const Joint& joint = rich_.cell.arm->joints[1];
  const Eigen::Vector3d a = twistBasis(joint).col(0).head<3>();
  const Eigen::AngleAxisd turn(kTilt * std::sin(rich_.samples[1].q(1)), a);
  const Eigen::Isometry3d motion = Eigen::Translation3d(joint.anchor) * turn * Eigen::Translation3d(-joint.anchor);
  for (std::size_t k = 1; k < tilted.joints.size(); ++k) tilted.joints[k].xi = adjoint(motion) * tilted.joints[k].xi;
  tilted.gamma = logSe3(motion * expSe3(tilted.gamma));
  EXPECT_THAT(disturbedFlange(rich_.cell, rich_.samples[1], wobble), PoseIsNear(forwardKinematics(tilted, rich_.samples[1].q), kRounding));
}

TEST_F(Shapes, BendingTurnsAcrossTheAxisAlongTheMoment) {
  const Joint& joint = rich_.cell.arm->joints[2];
  const Vector6d bend = disturbance(effectOf(rich_, "link_bending", "link:3", {{"compliance", 1e-5}}), 1).links[2];
  const Eigen::Vector3d moment = rich_.context(1).moment_body.col(2);
  EXPECT_NEAR(bend.head<3>().dot(joint.axis()), 0.0, kRounding);
  EXPECT_THAT(bend.head<3>(), IsNear(Eigen::Vector3d(1e-5 * (moment - joint.axis() * joint.axis().dot(moment))), kRounding));
  EXPECT_THAT(expSe3(bend) * joint.anchor, IsNear(joint.anchor, kRounding));
}

TEST_F(Shapes, ExpansionLengthensTheLink) {
  // 4 K at sample 2: an arm of joints and a flange 1 + 1e-3 times as far apart along link 5.
  const Vector6d growth = disturbance(effectOf(rich_, "link_expansion", "link:5", {{"expansion", 2.5e-4}}), 2).links[4];
  const std::vector<Joint>& joints = rich_.cell.arm->joints;
  EXPECT_THAT(growth.tail<3>(), IsNear(Eigen::Vector3d(1e-3 * (joints[5].anchor - joints[4].anchor)), kRounding));
  EXPECT_EQ(growth.head<3>().norm(), 0.0);
}

TEST_F(Shapes, BaseTiltsWithTheMoment) {
  const Disturbance tilt = disturbance(effectOf(rich_, "base_compliance", "base", {{"compliance", 1e-5}}), 1);
  EXPECT_NEAR(tilt.base.head<3>().dot(rich_.capture->gravity), 0.0, kRounding) << "gravity has no moment about its own direction";
  EXPECT_GT(tilt.base.norm(), 0.0);
}

TEST_F(Shapes, LensIsAnotherCamera) {
  Cell other = rich_.cell;
  other.camera->distortion(0) += 0.02;
  other.camera->distortion(3) -= 1e-3;
  const auto expected = disturbedCorners(other, rich_.samples[0], rich_.target.points, {});
  const auto actual = corners(effectOf(rich_, "lens_distortion", "camera.lens", {{"dk1", 0.02}, {"dp2", -1e-3}}), 0);
  for (std::size_t j = 0; j < expected.size(); ++j) EXPECT_THAT(*actual[j], IsNear(*expected[j], 1e-10));
}

TEST_F(Shapes, ScaledTargetIsALargerOne) {
  const Disturbance larger = disturbance(effectOf(rich_, "target_scale", "target.shape", {{"scale", 0.05}}), 0);
  const auto moved = [&](std::size_t j) { return Eigen::Vector3d(rich_.target.points[j].p_target + larger.points[j]); };
  EXPECT_NEAR((moved(1) - moved(0)).norm(), 1.05 * 0.08, kRounding);
  EXPECT_NEAR((moved(6) - moved(5)).norm(), 1.05 * 0.06, kRounding);
}

TEST_F(Shapes, LayoutMovesOneTag) {
  const Disturbance shift = disturbance(effectOf(rich_, "target_layout", "target.shape", {{"tag", 9.0}, {"dy", 1e-3}}), 0);
  for (std::size_t j = 0; j < 4; ++j) EXPECT_EQ(shift.points[j].norm(), 0.0);
  for (std::size_t j = 4; j < 8; ++j) EXPECT_THAT(shift.points[j], IsNear(Eigen::Vector3d(0, 1e-3, 0), 0.0));
}

TEST_F(Shapes, RollingShutterIsTheArmAtEachRowsTime) {
  // Second formula: each corner by itself, the arm moved on by the time of the row in which the corner is seen (iterated).
  constexpr double kLineTime = 2e-5;
  const auto actual = corners(effectOf(rich_, "rolling_shutter", "camera.shutter", {{"line_time", kLineTime}}), 1);
  for (std::size_t j = 0; j < actual.size(); ++j) {
    const auto undisturbed = disturbedCorners(rich_.cell, rich_.samples[1], rich_.target.points, {});
    Sample later = rich_.samples[1];
    later.q += (undisturbed[j]->y() - 511.5) * kLineTime * later.dq;
    const auto expected = disturbedCorners(rich_.cell, later, rich_.target.points, {});
    // A milliradian of motion, whose second order is a thousandth of it.
    EXPECT_THAT(*actual[j], IsNear(*expected[j], 1e-3));
    EXPECT_GT((*actual[j] - *undisturbed[j]).norm(), 1e-2);
  }
}

TEST_F(Shapes, TimeOffsetIsTheArmLater) {
  Sample later = rich_.samples[1];
  later.q += 0.01 * later.dq;
  const Disturbance offset = disturbance(effectOf(rich_, "time_offset", "timing", {{"offset", 0.01}}), 1);
  EXPECT_THAT(disturbedFlange(rich_.cell, rich_.samples[1], offset), PoseIsNear(rich_.cell.baseFlange(later), kRounding));
}

TEST_F(Shapes, CornerBiasMovesEveryEdgeOut) {
  constexpr double kOutward = 0.4;
  const auto before = disturbedCorners(rich_.cell, rich_.samples[0], rich_.target.points, {});
  const auto after = corners(effectOf(rich_, "corner_bias", "detector", {{"outward", kOutward}}), 0);
  for (std::size_t first : {0u, 4u}) {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    for (std::size_t j = first; j < first + 4; ++j) center += 0.25 * *before[j];
    for (std::size_t side = 0; side < 4; ++side) {
      const std::size_t begin = first + side, end = first + (side + 1) % 4;
      const Eigen::Vector2d along = (*before[end] - *before[begin]).normalized();
      Eigen::Vector2d normal(-along.y(), along.x());
      if (normal.dot(center - *before[begin]) > 0.0) normal = -normal;
      EXPECT_NEAR(normal.dot(*after[begin] - *before[begin]), kOutward, 1e-9);
      EXPECT_NEAR(normal.dot(*after[end] - *before[begin]), kOutward, 1e-9);
    }
  }
}

TEST_F(Shapes, RandomOnesAreDrawnForTheSimulatorAlone) {
  const AppliedEffect scatter = effectOf(rich_, "joint_scatter", "joint:2", {{"sigma", 1e-3}, {"seed", 4.0}});
  EXPECT_EQ(disturbance(scatter, 0).joints.norm(), 0.0);
  const auto drawn = [&](std::size_t number) {
    return disturbanceOf({scatter}, makeSampleContext(rich_.capture, rich_.samples[0], number, rich_.target.points), true).joints(1);
  };
  EXPECT_EQ(drawn(7), drawn(7));
  // 400 draws: the deviation of their standard deviation is 3.5 %; 15 % is beyond four of it.
  double sum = 0.0;
  for (std::size_t number = 0; number < 400; ++number) sum += drawn(number) * drawn(number);
  EXPECT_NEAR(std::sqrt(sum / 400.0), 1e-3, 1.5e-4);
}

TEST_F(Shapes, BadSamplesAreTheirShare) {
  const AppliedEffect bad = effectOf(rich_, "bad_samples", "samples", {{"share", 0.1}, {"sigma", 0.02}});
  int count = 0;
  for (std::size_t number = 0; number < 400; ++number) {
    const auto context = makeSampleContext(rich_.capture, rich_.samples[0], number, {});
    count += disturbanceOf({bad}, context, true).joints.norm() > 0.0 ? 1 : 0;
  }
  // Binomial, deviation 6: four of it either way.
  EXPECT_NEAR(count, 40, 24);
}

TEST_F(Shapes, UnknownMassesAreParameters) {
  // What a known compliance and known masses do, the masses' own numbers times the compliance do at an arm that has none.
  constexpr double kCompliance = 2e-5, kDifference = 7e-6;
  for (Sample& sample : rich_.samples) sample.payload = 1.5;
  const std::vector<LinkMass> links = rich_.cell.arm->links;
  const AppliedEffect known[] = {effectOf(rich_, "joint_compliance", "joint:2", {{"compliance", kCompliance}}),
                                 effectOf(rich_, "link_bending", "link:3", {{"compliance", kCompliance}, {"difference", kDifference}}),
                                 effectOf(rich_, "base_compliance", "base", {{"compliance", kCompliance}})};
  test::RichCell bare = rich_;
  bare.cell.arm->links.clear();
  bare.capture = makeCaptureContext(bare.cell, bare.target, rich_.capture->gravity, bare.samples);
  for (const AppliedEffect& effect : known) {
    std::map<std::string, double> ways{{"", kCompliance}};
    if (effect.effect.name() == "link_bending") ways = {{"_a", kCompliance + kDifference}, {"_b", kCompliance - kDifference}};
    std::map<std::string, double> numbers;
    for (const auto& [way, compliance] : ways) {
      for (std::size_t body = effect.effect.index(); body < links.size(); ++body) {
        const std::string number = std::to_string(body + 1) + way;
        numbers["m" + number] = compliance * links[body].mass;
        numbers["mx" + number] = compliance * links[body].mass * links[body].com.x();
        numbers["my" + number] = compliance * links[body].mass * links[body].com.y();
        numbers["mz" + number] = compliance * links[body].mass * links[body].com.z();
      }
      numbers["payload" + way] = compliance;
    }
    const AppliedEffect by_masses = effectOf(bare, effect.effect.name(), effect.effect.location(), numbers);
    EXPECT_TRUE(by_masses.effect.byMasses());
    const Disturbance expected = disturbance(effect, 1), actual = disturbanceOf({by_masses}, bare.context(1));
    EXPECT_THAT(actual.joints, IsNear(expected.joints, kRounding));
    EXPECT_THAT(actual.base, IsNear(expected.base, kRounding));
    for (std::size_t k = 0; k < links.size(); ++k) EXPECT_THAT(actual.links[k], IsNear(expected.links[k], kRounding));
  }
  EXPECT_THROW(effectOf(bare, "joint_compliance", "joint:2", {{"compliance", kCompliance}}), InvalidArgument);
}

}  // namespace
}  // namespace poecal
