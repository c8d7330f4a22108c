// Explanations weighed again where one linearisation cannot tell them apart, and fits that come to rest.
#include "diagnosis/ranking.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "diagnosis/refit.hpp"
#include "diagnosis/small_cell.hpp"

namespace poecal {
namespace {

using ::testing::SizeIs;

constexpr double kSigma = 0.1;  // [px]

Linearised refitted(const MeasuredCell& measured) {
  return refit(measured, test::nominalState(measured), {}, {}, NoiseEstimate{}, {}, true);
}

TEST(Refit, ComesToRestWhereTheRowsAreServedBest) {
  const MeasuredCell measured = test::smallCell(21, 60, kSigma, {}).measured();
  const Linearised fitted = refitted(measured);
  EXPECT_TRUE(fitted.settled);
  // From there a fit at the same noise goes nowhere: less than a tenth of a standard deviation in any direction.
  Linearised again = linearise(measured, fitted.state, {}, {}, {});
  setNoise(measured, fitted.noise, again);
  const Eigen::VectorXd moves = again.noise.b.cwiseQuotient(again.noise.covariance.diagonal().cwiseSqrt());
  EXPECT_LT(moves.cwiseAbs().maxCoeff(), 0.1);
  // 480 numbers less some 30 that the arm takes, to four standard deviations of such a mean.
  EXPECT_NEAR(std::sqrt(*varianceOf("corner", again.components, again.noise)), kSigma, 4.0 * kSigma / std::sqrt(2.0 * 450.0));
}

double weightOf(const Ranking& ranking, const std::string& name, const std::string& location) {
  const auto found = std::find_if(ranking.answers.begin(), ranking.answers.end(),
                                  [&](const RankedAnswer& each) { return each.name == name && each.place.name() == location; });
  return found == ranking.answers.end() ? -1e9 : found->log_weight;
}

// The same data but for the sign: what stiffens under a load is no compliance.
TEST(Ranking, AComplianceIsNotNegative) {
  const auto weight = [](double compliance) {
    const MeasuredCell measured =
        test::smallCell(22, 60, kSigma, {{"joint_compliance", "joint:3", {{"compliance", compliance}}}}).measured();
    const Linearised linear = refitted(measured);
    const std::vector<Candidate> candidates = allCandidates(measured, linear.state).candidates;
    return weightOf(rank(measured, candidates, nullptr, linear, {}, {}, ""), "joint_compliance", "joint:3");
  };
  const double yields = weight(1e-4);
  EXPECT_GT(yields, 20.0);
  EXPECT_LT(weight(-1e-4), yields - 20.0);
}

// A drift so fast that poses which see no other one see it: no answer beside another finding, until it was one.
TEST(Ranking, WhatWasFoundIsWeighedAgainWhateverItsSize) {
  const MeasuredCell measured = test::smallCell(24, 60, kSigma, {}).measured();
  const Linearised linear = refitted(measured);
  std::vector<Candidate> candidates = allCandidates(measured, linear.state).candidates;
  const auto gain = std::find_if(candidates.begin(), candidates.end(), [](const Candidate& candidate) {
    return candidate.name == "joint_gain" && candidate.place.name() == "joint:2";
  });
  ASSERT_NE(gain, candidates.end());
  gain->typical *= 1e-6;
  const auto listed = [&](const std::vector<Candidate>& kept) {
    return weightOf(rank(measured, candidates, nullptr, linear, {"another@base/none"}, kept, ""), "joint_gain", "joint:2") > -1e9;
  };
  EXPECT_FALSE(listed({}));
  EXPECT_TRUE(listed({*gain}));
}

class ComplianceByMasses : public ::testing::TestWithParam<std::uint64_t> {};

// A wave of two joints follows the torque with two numbers, where the compliance has eighteen of masses that nobody stated; what is
// believed of these makes up for it.
TEST_P(ComplianceByMasses, IsMoreProbableThanItsWaves) {
  test::SmallCell small = test::smallCell(GetParam(), 60, kSigma, {{"joint_compliance", "joint:3", {{"compliance", 1e-4}}}});
  small.nominal.links.clear();
  const MeasuredCell measured = small.measured();
  const Linearised linear = refitted(measured);
  const WaveDictionary waves(*measured.start.arm, measured.samples);
  const Ranking ranking = rank(measured, allCandidates(measured, linear.state).candidates, &waves, linear, {}, {}, "");
  EXPECT_GT(weightOf(ranking, "joint_compliance", "joint:3"), weightOf(ranking, "unknown", "joint:3"));
}

INSTANTIATE_TEST_SUITE_P(Seeds, ComplianceByMasses, ::testing::Values(100, 101, 102, 103));

// It moves corners by some ten pixels: weighed at the arm without it, wrong masses of a compliance imitate it.
TEST(Ranking, ALargeGainAtTheShoulderIsAGain) {
  constexpr std::size_t kSeen = 80;
  const test::SmallCell whole = test::smallCell(23, 160, kSigma, {{"joint_gain", "joint:2", {{"gain", 0.018}}}});
  const Diagnosis diagnosis = whole.head(kSeen).diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "joint_gain");
  EXPECT_EQ(diagnosis.findings.front().location, "joint:2");
  const double noise = 2.0 * kSigma * kSigma, beyond = std::pow(whole.rmsOf(diagnosis.model, kSeen), 2) - noise;
  EXPECT_LT(std::sqrt(std::max(0.0, beyond)), 0.06);  // [px]
}

}  // namespace
}  // namespace poecal
