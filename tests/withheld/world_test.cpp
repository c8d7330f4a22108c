// Is the withheld world what it says it is? Each figure against a second formula.
#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "withheld/baselines.hpp"
#include "withheld/case.hpp"
#include "withheld/choice.hpp"
#include "withheld/listed_flaws.hpp"
#include "withheld/setting.hpp"

namespace withheld {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

Case settingOf(const std::string& family, std::uint64_t seed) {
  Case made;
  Chance chance(seed);
  Wishes wishes;
  wishes.family = family;
  wishes.stamp = wishes.dir = true;
  drawSetting(made, wishes, chance);
  return made;
}

Flaw listed(const Case& made, const std::string& place) {
  for (const Flaw& flaw : listedFlaws(made.actual, made.columns, {})) {
    if (flaw.place() == place) return flaw;
  }
  throw std::invalid_argument("no " + place);
}

TEST(Leftover, ReachesAllOfSixNumbersAFrameThatGeometryCanShow) {
  const Case six = settingOf("cobot", 1), seven = settingOf("seven", 2);
  // 4 numbers a revolute axis, 6 for where camera and target are.
  EXPECT_EQ(Leftover(six.actual, six.shots, six.noise, false).rank(), 4 * 6 + 6);
  EXPECT_EQ(Leftover(seven.actual, seven.shots, seven.noise, false).rank(), 4 * 7 + 6);
}

TEST(Leftover, LeavesOfNoiseItsDegreesOfFreedom) {
  const Case made = settingOf("wrist", 3);
  const Leftover leftover(made.actual, made.shots, made.noise, false);
  Chance chance(4);
  const Eigen::Index rows = 8 * static_cast<Eigen::Index>(made.shots.size() * made.actual.tags.size());
  Eigen::VectorXd noise(rows);
  for (double& coordinate : noise) coordinate = chance.normal(made.noise.corner);
  const auto freedom = static_cast<double>(rows - leftover.rank());
  // Chi-square has variance 2 freedom; four sigma.
  EXPECT_THAT(leftover.withoutGeometry(noise).squaredNorm(), DoubleNear(freedom, 4.0 * std::sqrt(2.0 * freedom)));
}

TEST(Leftover, IsTheChiSquareOfALeastSquaresFit) {
  Case made = settingOf("cobot", 5);
  made.noise = {0.1, 0.05, 3e-5};
  const Leftover leftover(made.actual, made.shots, made.noise, false);
  Flaw flaw = listed(made, "joint_backlash@joint:2");
  flaw.parameters[0].value = 3e-4;

  // By singular values instead of pivoting, and without bringing columns to one length.
  const std::vector<Eigen::MatrixXd> factors = noiseFactors(made.actual, made.shots, made.noise);
  const Eigen::MatrixXd J = whiten(geometryColumns(made.actual, made.shots, false), factors);
  const Eigen::VectorXd r = whiten(corners(made.actual, made.shots, {flaw}) - corners(made.actual, made.shots, {}), factors);
  Eigen::BDCSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-8);
  const Eigen::VectorXd x = svd.solve(r);
  EXPECT_THAT(leftover.size(flaw), DoubleNear((r - J * x).norm(), 1e-3));
  EXPECT_GT(leftover.size(flaw), 5.0);
}

TEST(Leftover, IsNothingForAZeroThatIsOff) {
  const Case made = settingOf("seven", 6);
  const Leftover leftover(made.actual, made.shots, made.noise, false);
  // To first order nothing; 1e-5 rad leaves second order, some 1e-10 of 2400 px.
  EXPECT_LT(leftover.size(zeroOffset(3, 1e-5)), 1e-4);
}

TEST(GravityLoads, TorqueIsThePotentialsSlope) {
  for (const char* family : {"cobot", "wrist", "seven", "scara"}) {
    const Case made = settingOf(family, 7);
    const double payload = 1.5;
    const auto potential = [&](const Eigen::VectorXd& q) {
      Frame T = Frame::Identity();
      double height_times_mass = 0.0;
      for (std::size_t k = 0; k < made.actual.arm.size(); ++k) {
        const Joint& joint = made.actual.arm.joints[k];
        T = T * joint.T_before * joint.moved(q[static_cast<Eigen::Index>(k)]);
        height_times_mass += made.actual.arm.bodies[k].mass * (T * made.actual.arm.bodies[k].com).z();
      }
      return made.actual.gravity * (height_times_mass + payload * (T * made.actual.arm.T_last_flange).p.z());
    };
    const Shot& shot = made.shots.front();
    const Loads loads = gravityLoads(made.actual, flawless(made.actual, shot), payload);
    for (Eigen::Index k = 0; k < shot.q.size(); ++k) {
      const double step = 1e-5;
      Eigen::VectorXd ahead = shot.q, behind = shot.q;
      ahead[k] += step;
      behind[k] -= step;
      // Rounding of some 100 J over the step: 1e-9.
      EXPECT_THAT(loads.torque[k], DoubleNear(-(potential(ahead) - potential(behind)) / (2.0 * step), 1e-6))
          << family << " joint " << k + 1;
    }
  }
}

TEST(Corners, OfEdgesThatMoveOutLieOnParallelEdges) {
  const Case made = settingOf("wrist", 8);
  Flaw flaw = listed(made, "corner_bias@detector");
  flaw.parameters[0].value = 0.7;
  const Eigen::VectorXd still = corners(made.actual, made.shots.front(), {});
  const Eigen::VectorXd moved = corners(made.actual, made.shots.front(), {flaw});
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = still.segment<2>(2 * i), b = still.segment<2>(2 * ((i + 1) % 4));
    const Eigen::Vector2d normal = Eigen::Vector2d((b - a).y(), -(b - a).x()).normalized();
    EXPECT_THAT(std::abs(normal.dot(moved.segment<2>(2 * i) - a)), DoubleNear(0.7, 1e-9));
    EXPECT_THAT(std::abs(normal.dot(moved.segment<2>(2 * ((i + 1) % 4)) - a)), DoubleNear(0.7, 1e-9));
  }
}

TEST(LogChiSquareTail, HasTheKnownValues) {
  // Two degrees: exp(-x / 2). One: erfc(sqrt(x / 2)).
  EXPECT_NEAR(logChiSquareTail(3000.0, 2.0), -1500.0, 1e-9);
  EXPECT_NEAR(logChiSquareTail(0.5, 2.0), -0.25, 1e-12);
  for (const double x : {0.3, 2.5, 40.0}) EXPECT_NEAR(logChiSquareTail(x, 1.0), std::log(std::erfc(std::sqrt(x / 2.0))), 1e-10);
}

TEST(Cases, AreTheSameForASeedAndOthersForAnother) {
  const Case once = makeCase("clean", 1, 3), again = makeCase("clean", 1, 3), other = makeCase("clean", 2, 3);
  EXPECT_EQ(once.sightings.front().pixels, again.sightings.front().pixels);
  EXPECT_NE(once.sightings.front().pixels, other.sightings.front().pixels);
}

TEST(Cases, LeaveWhatTheirSetSays) {
  const Case single = makeCase("single", 1, 0);
  ASSERT_EQ(single.hidden.size(), 1U);
  EXPECT_GE(single.hidden[0].S, 4.9);
  EXPECT_LE(single.hidden[0].S, 40.8);
  const Case pair = makeCase("pairs", 1, 0);
  ASSERT_EQ(pair.hidden.size(), 2U);
  EXPECT_NE(pair.hidden[0].flaw.location, pair.hidden[1].flaw.location);
  EXPECT_THAT(makeCase("unobservable", 1, 0).hidden, IsEmpty());
  const Case outside = makeCase("outside", 1, 0);
  EXPECT_THAT(outside.hidden[0].aliases, IsEmpty());
  EXPECT_GT(outside.hidden[0].left_by_nearest, 6.0);
}

TEST(Aliases, AShoulderThatYieldsIsAColumnThatBends) {
  // The column bends about the shoulder's axis with the moment that the shoulder yields to, but for a constant.
  const Case made = settingOf("cobot", 9);
  const Leftover leftover(made.actual, made.shots, made.noise, false);
  Flaw flaw = listed(made, "joint_compliance@joint:2");
  flaw.parameters[0].value = 1e-5;
  ASSERT_TRUE(scaleTo(15.0, leftover, flaw));
  Hidden hidden{flaw, leftover.size(flaw), true, {}, {}, "", 0.0};
  compareWithListed(made, leftover, hidden);
  EXPECT_THAT(hidden.aliases, ElementsAre("link_bending@link:1"));
}

}  // namespace
}  // namespace withheld
