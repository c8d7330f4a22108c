#include "diagnosis/gap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "diagnosis/folds.hpp"
#include "diagnosis/look_alikes.hpp"
#include "diagnosis/small_cell.hpp"
#include "poecal/registration/implausible.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

constexpr double kSigma = 0.1;  // [px]

double waves(const Eigen::VectorXd& q) { return 4e-4 * std::sin(5.0 * q(0) + 7.0 * q(2) + 6.0 * q(3)); }
double nothing(const Eigen::VectorXd&) { return 0.0; }

void expectNoiseBelowEveryStage(const Diagnosis& diagnosis) {
  for (const GapStage& stage : diagnosis.stages) {
    EXPECT_LE(diagnosis.noise_rms, stage.rms) << stage.stage;
    EXPECT_LE(diagnosis.noise_bounds.second, stage.rms) << stage.stage;
    EXPECT_LE(stage.excess, stage.rms) << stage.stage;
    EXPECT_NEAR(std::hypot(stage.excess, diagnosis.noise_rms), stage.rms, 1e-9) << stage.stage;
  }
  EXPECT_LE(diagnosis.noise_bounds.first, diagnosis.noise_rms);
  EXPECT_GE(diagnosis.noise_bounds.second, diagnosis.noise_rms);
  EXPECT_LE(diagnosis.after_interval.first, diagnosis.after_excess);
  EXPECT_GE(diagnosis.after_interval.second, diagnosis.after_excess);
}

TEST(SurenessText, NeverSaysThatThereIsNoDoubt) {
  EXPECT_EQ(surenessText(1.0), "99.9 % sure or more");
  EXPECT_EQ(surenessText(0.9989), "99.8 % sure");
  EXPECT_EQ(surenessText(0.9951), "99.5 % sure");
  EXPECT_EQ(surenessText(0.67), "67 % sure");
}

// What no explanation follows moves corners by some 0.3 px, three times the noise. None of it is noise of the corners.
TEST(Gap, StructureThatNothingExplainsIsNoNoise) {
  test::SmallCell small = test::smallCell(21, 60, kSigma, {});
  test::observeWith(small, 0, waves, kSigma);
  const Diagnosis diagnosis = small.diagnosis();
  expectNoiseBelowEveryStage(diagnosis);
  // 120 numbers beside free poses: a deviation to 6 %, three times.
  const double noise = std::sqrt(2.0) * kSigma;
  EXPECT_NEAR(diagnosis.noise_bounds.first, noise, 0.2 * noise);
  if (!diagnosis.shrinkage.claimed()) return;
  EXPECT_LT(diagnosis.shrinkage.interval.first, 0.6) << "nobody foretells it";
}

// Readings to a tenth of a radian: no effect, and tens of pixels that all joints coming to rest at random would explain.
TEST(Gap, OfReadingsThatDoNotFitIsNotNothing) {
  test::SmallCell small = test::smallCell(24, 60, kSigma, {});
  for (std::size_t k = 0; k < small.samples.size(); ++k) {
    small.samples[k].q = (10.0 * small.samples[k].q).array().round() / 10.0;
    small.observations[k].q = small.samples[k].q;
  }
  const Diagnosis diagnosis = small.diagnosis();
  expectNoiseBelowEveryStage(diagnosis);
  EXPECT_TRUE(diagnosis.gap_remains);
  EXPECT_FALSE(diagnosis.isClean());
  EXPECT_THAT(diagnosisText(diagnosis, small.samples), HasSubstr("input that does not belong together"));
}

TEST(Gap, OfATidyCellIsWhatTheCovarianceSays) {
  const Diagnosis diagnosis = test::smallCell(22, 60, kSigma, {}).diagnosis();
  expectNoiseBelowEveryStage(diagnosis);
  EXPECT_TRUE(diagnosis.isClean());
  const double noise = std::sqrt(2.0) * kSigma;
  EXPECT_NEAR(diagnosis.noise_rms, noise, 0.15 * noise);
  // 36 unknowns and 480 numbers: a share of 36 / 480 of the noise's square.
  EXPECT_NEAR(diagnosis.after_excess, noise * std::sqrt(36.0 / 480.0), 0.5 * noise * std::sqrt(36.0 / 480.0));
}

TEST(Gap, OfPosesWithoutRepeatsOrDeviationsSubtractsNoNoise) {
  test::SmallCell small = test::smallCell(23, 60, kSigma, {});
  constexpr double kPosition = 2e-5;  // [m] an axis
  test::measurePoses(small, 0, nothing, kPosition);
  const Diagnosis diagnosis = small.diagnosis();
  expectNoiseBelowEveryStage(diagnosis);
  EXPECT_EQ(diagnosis.noise_source, NoiseSource::kUnknown);
  EXPECT_EQ(diagnosis.noise_rms, 0.0);
  EXPECT_NEAR(diagnosis.noise_bounds.second, std::sqrt(3.0) * kPosition, 0.2 * std::sqrt(3.0) * kPosition);
  EXPECT_THAT(diagnosisText(diagnosis, small.samples), HasSubstr("noise not known: no repeats, no stated deviation"));
}

TEST(Gap, OfPosesTakenTwiceHasTheNoiseOfTheRepeats) {
  test::SmallCell small = test::smallCell(24, 40, kSigma, {});
  std::vector<Sample> twice;
  for (std::size_t k = 0; k < small.samples.size(); ++k) {
    small.samples[k].pose = static_cast<long>(k);
    twice.insert(twice.end(), 2, small.samples[k]);
  }
  small.samples = twice;
  small.observations.resize(twice.size());
  for (std::size_t k = 0; k < twice.size(); ++k) {
    small.observations[k] = {};
    small.observations[k].sample = k;
    small.observations[k].q = twice[k].q;
  }
  constexpr double kPosition = 2e-5;
  test::measurePoses(small, 0, waves, kPosition);
  const Diagnosis diagnosis = small.diagnosis();
  EXPECT_EQ(diagnosis.noise_source, NoiseSource::kRepeats);
  // 120 numbers.
  EXPECT_NEAR(diagnosis.noise_rms, std::sqrt(3.0) * kPosition, 0.2 * std::sqrt(3.0) * kPosition);
  expectNoiseBelowEveryStage(diagnosis);
}

// 4e-4 rad at a joint of some 0.5 m that nothing but random motion seems to explain.
TEST(Gap, ScatterWithoutRepeatsIsNeverSure) {
  test::SmallCell small = test::smallCell(25, 60, kSigma, {});
  test::measurePoses(small, 0, waves, 1e-5);
  const Diagnosis diagnosis = small.diagnosis();
  for (const Finding& finding : diagnosis.findings) {
    if (finding.effect != "joint_scatter") continue;
    EXPECT_LT(finding.probability, 0.9);
    EXPECT_FALSE(finding.alternatives.empty());
    EXPECT_THAT(finding.separate_with, HasSubstr("taken again"));
  }
  EXPECT_LT(diagnosis.shrinkage.interval.first, 0.5) << "nobody foretells it";
}

Rung rungOf(const std::vector<double>& squares) {
  Rung rung;
  for (const double one : squares) rung.poses.push_back({one, 4.0});
  return rung;
}

// What shows in one pose of ten is far from significant in their mean, though none of the others loses by it.
TEST(Gains, OfAFewPosesAreNotLostByTheOthers) {
  const std::vector<double> before(10, 9.0);
  std::vector<double> after = before;
  after[3] = 1.0;
  EXPECT_NEAR(gain(rungOf(before), rungOf(after)), 1.0 / std::sqrt(0.9), 1e-12);
  EXPECT_EQ(lostShare(rungOf(before), rungOf(after)), 0.0);
  after[5] = 15.0;
  EXPECT_EQ(lostShare(rungOf(before), rungOf(after)), 0.75);
  EXPECT_EQ(lostShare(rungOf(after), rungOf(after)), std::numeric_limits<double>::infinity());
}

MeasuredCell measuredOf(const test::SmallCell& small) {
  MeasuredCell measured;
  measured.observations = small.observations;
  measured.samples = small.samples;
  for (std::size_t k = 0; k < small.observations.size(); ++k) measured.groups.push_back({k});
  return measured;
}

TEST(Folds, HoldEveryPoseOutOnce) {
  const MeasuredCell measured = measuredOf(test::smallCell(26, 47, kSigma, {}));
  for (const HeldOut kind : {HeldOut::kRandom, HeldOut::kTime, HeldOut::kPosture}) {
    std::vector<std::size_t> all;
    for (const auto& fold : makeFolds(measured, kind, 5, 1)) {
      EXPECT_FALSE(fold.empty());
      EXPECT_TRUE(std::is_sorted(fold.begin(), fold.end()));
      all.insert(all.end(), fold.begin(), fold.end());
    }
    std::sort(all.begin(), all.end());
    ASSERT_EQ(all.size(), 47u);
    for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k], k);
  }
}

TEST(Folds, OfTimeFollowEachOther) {
  for (const auto& fold : makeFolds(measuredOf(test::smallCell(26, 47, kSigma, {})), HeldOut::kTime, 5, 1)) {
    EXPECT_EQ(fold.back() - fold.front() + 1, fold.size());
  }
}

TEST(Folds, OfPostureLieNearEachOther) {
  const MeasuredCell measured = measuredOf(test::smallCell(26, 60, kSigma, {}));
  const auto spread = [&measured](const Folds& folds) {
    double sum = 0.0;
    for (const auto& fold : folds) {
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(6);
      for (const std::size_t g : fold) mean += measured.samples[g].q / static_cast<double>(fold.size());
      for (const std::size_t g : fold) sum += (measured.samples[g].q - mean).squaredNorm();
    }
    return sum;
  };
  EXPECT_LT(spread(makeFolds(measured, HeldOut::kPosture, 5, 1)), 0.9 * spread(makeFolds(measured, HeldOut::kRandom, 5, 1)));
}

TEST(TwoValues, TellPlayFromScatter) {
  Rng rng(3);
  Eigen::VectorXd play(40), scatter(40);
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(40, 1e-5);
  for (Eigen::Index k = 0; k < 40; ++k) {
    play(k) = (rng.uniform() < 0.5 ? -1.0 : 1.0) * 1e-4 + 1e-5 * rng.normal();
    scatter(k) = 1e-4 * rng.normal() + 1e-5 * rng.normal();
  }
  EXPECT_GT(twoValues(play, deviations).log_odds, 20.0);
  EXPECT_NEAR(twoValues(play, deviations).size, 1e-4, 1e-5);
  EXPECT_LT(twoValues(scatter, deviations).log_odds, -20.0);
}

/// Poses of an instrument whose tool turns about the very point that is measured, from the middle of the capture on.
test::SmallCell cellOfATurnedTool(double angle) {
  test::SmallCell small = test::smallCell(6, 60, 0.1, {});
  const auto exact = [](const Eigen::VectorXd&) { return 0.0; };
  test::measurePoses(small, 0, exact, 2e-5);
  for (std::size_t k = 30; k < small.observations.size(); ++k) {
    small.observations[k].pose->T_camera_target.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  }
  return small;
}

TEST(Gap, OfATurnedToolCountsThoughNoPointMoved) {
  const Diagnosis diagnosis = cellOfATurnedTool(0.02).diagnosis();
  ASSERT_EQ(diagnosis.findings.size(), 1u);
  EXPECT_EQ(diagnosis.findings.front().effect, "target_slip");
  EXPECT_FALSE(diagnosis.findings.front().shrinkage.claimed()) << "it is one of points, which stay where they were";
}

TEST(Gap, IsNotTriedWhereNoArmExplainsThePoses) { EXPECT_THROW(cellOfATurnedTool(M_PI).diagnosis(), ImplausibleCapture); }

}  // namespace
}  // namespace poecal
