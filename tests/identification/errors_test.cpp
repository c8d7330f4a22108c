// Errors of the flange that corners tell, against the errors that there are.
#include "poecal/identification/errors.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "identification/simulated_cell.hpp"
#include "poecal/core/random.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/registration/target_pose.hpp"

namespace poecal {
namespace {

/// True errors of a cell's flange in position [m], and those of the pose that each picture's corners alone give.
struct Compared {
  std::vector<double> truth, raw;
  ErrorSummary told;
};

Compared compare(const test::Simulated& data, const Cell& model) {
  Compared compared;
  ErrorCollector collector(1.0);  // the corners state their deviation, 0.1 px
  for (std::size_t k = 0; k < data.calibration.size(); ++k) {
    const Observation& observation = data.calibration[k];
    const Eigen::Isometry3d true_flange = modelFlange(data.truth, observation), flange = modelFlange(model, observation);
    compared.truth.push_back((true_flange.translation() - flange.translation()).norm());
    const Eigen::Isometry3d free =
        refinePose(*model.camera, observation, data.truth.registration.cameraTarget(true_flange)).T_camera_target;
    compared.raw.push_back((model.registration.baseFlange(free).translation() - flange.translation()).norm());
    collector.add(model, k, observation);
  }
  compared.told = collector.summary();
  return compared;
}

TEST(FlangeErrors, AreThoseThatThereAreWithoutTheTagsNoise) {
  const test::Simulated data = test::simulated("cobot6", 41, 60, 0);
  Cell model = data.truth;
  // 0.1 mm and 0.3 mrad, below what a single tag tells of its pose.
  Rng rng(5);
  Eigen::VectorXd beta(twistParameterCount(*model.arm));
  for (Eigen::Index k = 0; k < beta.size(); ++k) beta(k) = (k % 4 < 2 ? 1.5e-4 : 1e-4) * rng.normal();
  model.arm = displaceTwists(*model.arm, beta);
  const Compared compared = compare(data, model);
  EXPECT_GT(rms(compared.raw), 2.0 * rms(compared.truth)) << "otherwise this case shows nothing";
  // Sixty poses whose errors hang together: a mean square known to a quarter.
  EXPECT_NEAR(compared.told.position.rms / rms(compared.truth), 1.0, 0.25);
  EXPECT_GE(compared.told.position.max, compared.told.position.p95);
  EXPECT_GE(compared.told.position.p95, compared.told.position.median);
}

TEST(FlangeErrors, OfTheTrueArmAreNearlyNone) {
  const test::Simulated data = test::simulated("cobot6", 42, 60, 0);
  const Compared compared = compare(data, data.truth);
  EXPECT_LT(compared.told.position.rms, 0.15 * rms(compared.raw));
}

TEST(FlangeErrors, AWildRowLeavesThoseOfTheOthersAlone) {
  const test::Simulated data = test::simulated("cobot6", 44, 60, 0);
  Rng rng(6);
  Eigen::VectorXd beta(twistParameterCount(*data.truth.arm));
  for (Eigen::Index k = 0; k < beta.size(); ++k) beta(k) = (k % 4 < 2 ? 1.5e-4 : 1e-4) * rng.normal();
  Cell model = data.truth;
  model.arm = displaceTwists(*model.arm, beta);
  ErrorCollector tidy(1.0), spoilt(1.0);
  for (std::size_t k = 0; k < data.calibration.size(); ++k) {
    Observation observation = data.calibration[k];
    tidy.add(model, k, observation);
    for (CornerMeasurement& corner : observation.corners) corner.px.x() += k == 7 ? 40.0 : 0.0;
    spoilt.add(model, k, observation);
  }
  EXPECT_NEAR(spoilt.summary().position.median, tidy.summary().position.median, 0.1 * tidy.summary().position.median);
  EXPECT_GT(spoilt.summary().position.max, 20.0 * tidy.summary().position.max) << "it counts for itself";
}

TEST(FlangeErrors, LargeOnesAreAsMeasured) {
  const test::Simulated data = test::simulated("cobot6", 43, 60, 0);
  Cell model = data.truth;
  Eigen::Isometry3d home = expSe3(model.arm->gamma);
  home.translation().x() += 0.02;  // the flange 20 mm aside
  model.arm->gamma = logSe3(home);
  const Compared compared = compare(data, model);
  EXPECT_NEAR(compared.told.position.mean, 0.02, 0.001);
}

// Of n poses with four normal numbers each, the rms is off by 1/sqrt(8 n) of itself (1 sigma): the mean of 4 n squares, whose variance
// is 2.
TEST(RmsInterval, IsAsWideAsChanceMakesIt) {
  constexpr int kPoses = 400, kNumbers = 4;
  Rng rng(3);
  std::vector<PoseSquares> poses(kPoses);
  double squares = 0.0;
  for (PoseSquares& pose : poses) {
    for (int k = 0; k < kNumbers; ++k) pose.squares += std::pow(0.2 * rng.normal(), 2);
    pose.points = kNumbers;
    squares += pose.squares;
  }
  const double rms = std::sqrt(squares / (kPoses * kNumbers));
  const auto [low, high] = rmsInterval(poses);
  const double expected = 1.96 * rms / std::sqrt(2.0 * kPoses * kNumbers);
  // The quantiles of 1000 resamples, and the variance that 400 poses tell, are each known to a tenth.
  EXPECT_NEAR(rms - low, expected, 0.25 * expected);
  EXPECT_NEAR(high - rms, expected, 0.25 * expected);
  EXPECT_EQ(rmsInterval(poses), std::pair(low, high));
}

TEST(RmsInterval, OfPosesThatAreAllTheSameIsTheirRms) {
  const std::vector<PoseSquares> poses(10, {.squares = 4.0, .points = 1.0});
  EXPECT_EQ(rmsInterval(poses), std::pair(2.0, 2.0));
  EXPECT_EQ(rmsInterval({}), std::pair(0.0, 0.0));
}

}  // namespace
}  // namespace poecal
