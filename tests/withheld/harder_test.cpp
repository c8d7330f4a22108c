// Are the harder sets what they say they are? Each against a second formula.
#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "withheld/harder_sets.hpp"
#include "withheld/strange_flaws.hpp"
#include "withheld/tables.hpp"

namespace withheld {
namespace {

constexpr std::uint64_t kSeed = 11;

/// T_base_flange, joint after joint.
Frame flangeOf(const Arm& arm, const Eigen::VectorXd& q) {
  Frame T = Frame::Identity();
  for (std::size_t k = 0; k < arm.size(); ++k) T = T * arm.joints[k].T_before * arm.joints[k].moved(q[static_cast<Eigen::Index>(k)]);
  return T * arm.T_last_flange;
}

TEST(InHand, TheTargetStandsWhereverTheCameraIsCarried) {
  const Case made = makeCase("in-hand", kSeed, 0);
  ASSERT_TRUE(made.told.in_hand);
  const Frame still = made.actual.T_mount_target;
  for (const Shot& shot : made.shots) {
    const Frame T_base_camera = flangeOf(made.actual.arm, shot.q) * made.actual.T_camera_mount.Inverse();
    const Frame seen = T_base_camera * targetInCamera(made.actual, flawless(made.actual, shot));
    EXPECT_LT((seen.p - still.p).Norm(), 1e-12);
  }
}

TEST(Half, TheUnlistedOneLeavesHalfAsMuchAsTheListedOne) {
  for (const Family family : {Family::first, Family::second}) {
    const Case made = makeCase("half", kSeed, 1, family);
    const Leftover leftover(made.actual, made.shots, made.noise, false);
    ASSERT_EQ(made.hidden.size(), 2U);
    EXPECT_TRUE(made.hidden[0].listed);
    EXPECT_FALSE(made.hidden[1].listed);
    // Both are scaled to 2 %.
    EXPECT_NEAR(leftover.size(made.hidden[1].flaw) / leftover.size(made.hidden[0].flaw), 0.5, 0.02);
    EXPECT_NE(made.hidden[0].flaw.location, made.hidden[1].flaw.location);
  }
}

TEST(Large, MovesCornersBySoManyPixels) {
  const Case made = makeCase("large", kSeed, 0);
  const Eigen::VectorXd moved = corners(made.actual, made.shots, {made.hidden[0].flaw}) - corners(made.actual, made.shots, {});
  double squares = 0.0;
  for (Eigen::Index i = 0; i < moved.size(); i += 2) squares += moved.segment<2>(i).squaredNorm();
  const double rms = std::sqrt(2.0 * squares / static_cast<double>(moved.size()));
  EXPECT_GT(rms, 5.0 * 0.98);
  EXPECT_LT(rms, 100.0 * 1.02);
}

TEST(Bare, JointsComeFromTheRowBeforeAndNoColumnSaysSo) {
  const Case made = makeCase("bare", kSeed, 0);
  for (std::size_t i = 1; i < made.shots.size(); ++i) {
    for (Eigen::Index k = 0; k < made.shots[i].q.size(); ++k) {
      EXPECT_GT((made.shots[i].q[k] - made.shots[i - 1].q[k]) * made.shots[i].dir[k], 0.0);
    }
  }
  EXPECT_FALSE(made.columns.stamp || made.columns.dir || made.columns.dq || made.columns.temperature);
  EXPECT_FALSE(made.told_masses);
}

TEST(Waves, AreOfThreeJointsAndNothingElse) {
  const Case made = makeCase("waves", kSeed, 0);
  const Flaw& flaw = made.hidden[0].flaw;
  const Shot& shot = made.shots[0];
  const auto at = static_cast<Eigen::Index>(std::stoul(flaw.location.substr(6))) - 1;
  const auto errs = [&](const Shot& s) { return stateAt(made.actual, s, {flaw}).q[at] - s.q[at]; };
  std::string drivers;
  for (Eigen::Index j = 0; j < shot.q.size(); ++j) {
    Shot turned = shot, round = shot;
    turned.q[j] += 0.3;
    round.q[j] += 2.0 * KDL::PI;
    if (std::abs(errs(turned) - errs(shot)) > 1e-6) drivers += (drivers.empty() ? "q" : ",q") + std::to_string(j + 1);
    EXPECT_NEAR(errs(round), errs(shot), 1e-12);  // whole factors: a turn of any joint changes nothing
  }
  EXPECT_EQ(drivers, flaw.driver);
}

TEST(Families, ShareNoShape) {
  std::set<std::string> first, second;
  for (std::uint64_t number = 0; number < 12; ++number) {
    for (const char* set : {"outside", "waves", "field-80"}) {
      first.insert(makeCase(set, kSeed, number, Family::first).hidden[0].flaw.effect);
      second.insert(makeCase(set, kSeed, number, Family::second).hidden[0].flaw.effect);
    }
  }
  for (const std::string& shape : first) EXPECT_EQ(second.count(shape), 0U) << shape;
  EXPECT_GT(first.size(), 4U);
  EXPECT_GT(second.size(), 4U);
}

TEST(HarderTable, CountsAnUnlistedEffectByItsPlaceAndOtherFindingsAsSuch) {
  Scored scored;
  scored.answered = true;
  scored.truth.set = "half";
  scored.truth.effects.resize(2);
  scored.truth.effects[0].effect = "joint_gain";
  scored.truth.effects[0].location = "joint:2";
  scored.truth.effects[1].effect = "bumps";
  scored.truth.effects[1].location = "joint:4";
  scored.truth.effects[1].listed = false;
  Finding gain, unknown, stray;
  gain.effect = "joint_gain";
  gain.location = "joint:2";
  unknown.effect = "unknown";
  unknown.location = "joint:4";
  stray.effect = "joint_slip";
  stray.location = "joint:1";
  scored.answer.findings = {gain, unknown};
  scored.verdict = judge(scored.truth, scored.answer);
  std::string text = tables({scored});
  EXPECT_THAT(text, testing::HasSubstr("| half | unlisted one unknown in its place | 100.0 % (1/1"));
  EXPECT_THAT(text, testing::HasSubstr("| half | another finding | 0.0 % (0/1"));
  scored.answer.findings.push_back(stray);
  scored.verdict = judge(scored.truth, scored.answer);
  text = tables({scored});
  EXPECT_THAT(text, testing::HasSubstr("| half | another finding | 100.0 % (1/1"));
}

}  // namespace
}  // namespace withheld
