// Waves of several joint angles: what is found first, that it is what whole matrices give, and how it serves poses that nobody saw.
#include "diagnosis/harmonics.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "diagnosis/refit.hpp"
#include "diagnosis/screening.hpp"
#include "diagnosis/small_cell.hpp"

namespace poecal {
namespace {

using ::testing::SizeIs;

constexpr double kSigma = 0.1;  // [px]

EffectSpec waveAtJointOne(double size) {
  return {.effect = "unknown", .location = "joint:1", .parameters = {{"sin(3q1+2q3+4q4)", size}}, .driver = "q1,q3,q4"};
}

using test::Fitted;
using test::fitted;

TEST(WaveDictionary, HoldsEveryWaveOnceAndItsSharesAddUp) {
  const test::SmallCell small = test::smallCell(1, 40, kSigma, {});
  const WaveDictionary dictionary(small.nominal, small.samples);
  // Of six joints, whole: 4 each alone, 4 x 8 of two, 4 x 8 x 8 of three. Of 0.5, 1 and 1.5: 3, 3 x 6 and 3 x 6 x 6, less the whole ones.
  EXPECT_THAT(dictionary.common(), SizeIs(6 * (4 + 2) + 15 * (32 + 18 - 2) + 20 * (256 + 108 - 4)));
  for (std::size_t k = 0; k < 6; ++k) {
    double sum = 0.0;
    for (const auto& entry : dictionary.common()) sum += std::exp(entry.log_share);
    for (const auto& entry : dictionary.own(k)) sum += std::exp(entry.log_share);
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
}

TEST(WaveDictionary, ASlidingOrStandingJointIsInNoWave) {
  test::SmallCell small = test::smallCell(1, 40, kSigma, {});
  small.nominal.joints[1] = Joint::prismatic("joint_2", Eigen::Vector3d::UnitY(), {0.0, 0.0, 0.0});
  for (Sample& sample : small.samples) sample.q(4) = 0.3;
  const WaveDictionary dictionary(small.nominal, small.samples);
  for (const auto& entry : dictionary.common()) {
    EXPECT_FALSE(entry.wave.contains(1) || entry.wave.contains(4)) << cosineName(entry.wave);
  }
  EXPECT_TRUE(dictionary.own(1).empty());
}

// Every whole wave as a candidate of its own, weighed by the screening that all other candidates go through.
TEST(Waves, TheFirstIsTheOneThatWholeMatricesPutFirst) {
  const Fitted made = fitted(test::smallCell(3, 60, kSigma, {waveAtJointOne(6e-4)}));
  const WaveDictionary dictionary(*made.measured.start.arm, made.measured.samples);
  const std::vector<Candidate> found = waveCandidates(WaveFolds(made.measured, made.linear), made.linear, dictionary, 1);
  const auto first = std::find_if(found.begin(), found.end(), [](const Candidate& each) {
    return each.place == Place{PlaceKind::kJoint, 0};
  });
  ASSERT_NE(first, found.end());
  ASSERT_THAT(first->curve->terms, SizeIs(1));
  std::vector<Candidate> all;
  for (const auto& entry : dictionary.common()) {
    Candidate one = *first;
    one.curve->terms = {entry.wave};
    one.typical.setConstant(entry.typical);
    one.log_prior = entry.log_share;
    all.push_back(std::move(one));
  }
  const std::vector<Evidence> evidence = screen(made.linear, all);
  std::size_t best = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (evidence[i].log_bayes + all[i].log_prior > evidence[best].log_bayes + all[best].log_prior) best = i;
  }
  EXPECT_EQ(first->curve->terms.front(), all[best].curve->terms.front());
  EXPECT_EQ(all[best].curve->terms.front(), (AngleWave{{0, 3.0}, {2, 2.0}, {3, 4.0}}));
}

TEST(Waves, DoNotDependOnTheNumberOfThreads) {
  Fitted made = fitted(test::smallCell(4, 60, kSigma, {waveAtJointOne(6e-4)}));
  const WaveDictionary dictionary(*made.measured.start.arm, made.measured.samples);
  const std::vector<Candidate> alone = waveCandidates(WaveFolds(made.measured, made.linear), made.linear, dictionary, 6);
  made.linear.jobs = 4;
  const std::vector<Candidate> together = waveCandidates(WaveFolds(made.measured, made.linear), made.linear, dictionary, 6);
  ASSERT_EQ(alone.size(), together.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i].answer(), together[i].answer());
    EXPECT_EQ(alone[i].log_prior, together[i].log_prior);
  }
}

TEST(Waves, AreNoneInNoise) {
  const Fitted made = fitted(test::smallCell(5, 80, kSigma, {}));
  const WaveDictionary dictionary(*made.measured.start.arm, made.measured.samples);
  EXPECT_TRUE(waveCandidates(WaveFolds(made.measured, made.linear), made.linear, dictionary, 10).empty());
}

// 0.6 mrad at the first joint: some 0.3 px beyond any geometry.
TEST(Waves, OfThreeJointsAreToldThereAndServePosesThatNobodySaw) {
  constexpr std::size_t kSeen = 80;
  const test::SmallCell whole = test::smallCell(6, 160, kSigma, {waveAtJointOne(6e-4)});
  const Diagnosis diagnosis = whole.head(kSeen).diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "unknown");
  EXPECT_EQ(diagnosis.findings.front().location, "joint:1");
  EXPECT_EQ(diagnosis.findings.front().driver, "q1,q3,q4");
  ASSERT_THAT(diagnosis.model.effects, SizeIs(1));
  Model without = diagnosis.model;
  without.effects.clear();
  const double noise = 2.0 * kSigma * kSigma;  // of both numbers of a corner
  EXPECT_LT(std::pow(whole.rmsOf(diagnosis.model, kSeen), 2) - noise, 0.2 * (std::pow(whole.rmsOf(without, kSeen), 2) - noise));
}

// Both ways in which structure takes the place of what explains more at first sight: two waves that each look random beside the other, and
// a mount that sways.
TEST(Waves, OfTwoKindsStandBesideASway) {
  test::SmallCell small = test::smallCell(74, 100, kSigma,
                                          {{.effect = "unknown",
                                            .location = "camera.mount",
                                            .parameters = {{"rx_sin(6.3)", 2e-4}, {"low", 0.0}, {"high", 99.0 * 30.0}},
                                            .driver = "stamp"},
                                           {.effect = "unknown",
                                            .location = "joint:2",
                                            .parameters = {{"sin(3q1-2q2+2q4)", 4e-4}, {"cos(q1+3q2-4q4)", 4e-4}},
                                            .driver = "q1,q2,q4"}});
  const Diagnosis diagnosis = small.diagnosis();
  std::vector<std::string> places;
  for (const Finding& finding : diagnosis.findings) places.push_back(finding.effect + "@" + finding.location);
  EXPECT_THAT(places, ::testing::UnorderedElementsAre("unknown@camera.mount", "unknown@joint:2")) << diagnosisText(diagnosis, {});
}

// A name that does the work of several waves is the answer.
TEST(Waves, StandBackWhereANamedEffectServes) {
  const Diagnosis diagnosis = test::smallCell(7, 80, kSigma, {{"joint_compliance", "joint:3", {{"compliance", 6e-5}}}}).diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_NE(diagnosis.findings.front().effect, "unknown");
}

}  // namespace
}  // namespace poecal
