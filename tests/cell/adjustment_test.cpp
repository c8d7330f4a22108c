#include "poecal/cell/adjustment.hpp"

#include <gmock/gmock.h>

#include "cell/linearisation.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "support/arms.hpp"
#include "support/cameras.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

Camera testCamera() { return test::plumbBob(1280, 960, {1400.0, 1390.0}, {640.0, 480.0}, {-0.1, 0.05, 0.001, -0.0005}); }

/// A cell whose target stays before the camera: joints move a little about zero, and the transforms are made to fit.
Cell testCell(Rng& rng, const std::string& joint_types, Setup setup) {
  Cell cell;
  cell.arm = test::randomArm(rng, joint_types);
  cell.camera = testCamera();
  cell.registration.setup = setup;
  cell.registration.T_far_target = test::randomPose(rng, 1.0, 0.1);
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  T_camera_target.translation() << 0.02, -0.03, 1.2;
  T_camera_target.linear() = expSo3({0.2, -0.3, 0.4});
  const Eigen::Isometry3d T_base_flange = forwardKinematics(*cell.arm, Eigen::VectorXd::Zero(cell.arm->jointCount()));
  const Eigen::Isometry3d T_near_far = setup == Setup::kEyeToHand ? T_base_flange : T_base_flange.inverse();
  cell.registration.T_camera_near = T_camera_target * cell.registration.T_far_target.inverse() * T_near_far.inverse();
  return cell;
}

std::vector<Observation> observe(const Cell& cell, Rng& rng, int poses, double sigma_px) {
  const Eigen::Matrix<double, 3, 4> corners = tagCorners(0.08);
  std::vector<Observation> observations;
  while (static_cast<int>(observations.size()) < poses) {
    Observation observation;
    observation.sample = observations.size();
    observation.q = test::uniformVector(rng, cell.arm->jointCount(), 0.35);
    const Eigen::Isometry3d T_camera_target = modelTarget(cell, observation);
    for (int k = 0; k < 4; ++k) {
      const auto px = project(*cell.camera, T_camera_target * corners.col(k));
      if (!px) break;
      observation.corners.push_back({{7, k}, corners.col(k), *px + sigma_px * Eigen::Vector2d(rng.normal(), rng.normal()), 1.0});
    }
    if (observation.corners.size() == 4) observations.push_back(std::move(observation));
  }
  return observations;
}

struct Case {
  const char* joints;
  Setup setup;
};

class AdjustmentOf : public ::testing::TestWithParam<Case> {};

TEST_P(AdjustmentOf, DerivativesMatchCentralDifferences) {
  constexpr double kStep = 1e-6;  // px per rad are about 1e3: truncation 1e-6, rounding 1e-7
  Rng rng = test::rngOfThisTest();
  const Cell cell = testCell(rng, GetParam().joints, GetParam().setup);
  const FreeParameters free{.twists = true, .gamma = true, .near = true, .far = true, .intrinsics = true};
  const ParameterLayout layout(cell, free);
  const CellState nominal(cell, free);
  const CellState state = nominal.moved(layout, test::uniformVector(rng, layout.total, 1e-3));
  for (const Observation& observation : observe(cell, rng, 3, 0.0)) {
    const PoseDerivative pose = evaluatePose(state, layout, observation);
    SampleRows rows;
    evaluateRows(state.cell, observation, pose.T_camera_target, true, rows);
    Eigen::MatrixXd J(rows.r.size(), layout.total);
    J << rows.H * pose.M, rows.K;
    for (int k = 0; k < layout.total; ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(layout.total, k);
      Eigen::VectorXd r[2];
      for (int side = 0; side < 2; ++side) {
        const CellState moved = state.moved(layout, side == 0 ? step : Eigen::VectorXd(-step));
        SampleRows moved_rows;
        evaluateRows(moved.cell, observation, modelTarget(moved.cell, observation), false, moved_rows);
        r[side] = moved_rows.r;
      }
      const Eigen::VectorXd numeric = (r[1] - r[0]) / (2.0 * kStep);  // r is measured - model
      EXPECT_THAT(Eigen::VectorXd(J.col(k)), test::IsNear(numeric, 1e-5 * (1.0 + numeric.norm())))
          << parameterNames(cell, free)[static_cast<std::size_t>(k)];
    }
  }
}

TEST_P(AdjustmentOf, DerivativesOfADisturbedPoseMatchCentralDifferences) {
  constexpr double kStep = 1e-6;
  Rng rng = test::rngOfThisTest();
  const Cell cell = testCell(rng, GetParam().joints, GetParam().setup);
  const FreeParameters free{.twists = true, .gamma = true, .near = true, .far = true};
  const ParameterLayout layout(cell, free);
  const CellState state = CellState(cell, free).moved(layout, test::uniformVector(rng, layout.total, 1e-3));
  constexpr double kLarge = 0.1;  // where an undisturbed cell's derivatives are off by a tenth
  Disturbance at = Disturbance::zero(cell, 0);
  at.joints = test::uniformVector(rng, cell.arm->jointCount(), kLarge);
  for (Vector6d& link : at.links) link = test::uniformVector(rng, 6, kLarge);
  for (Vector6d* port : {&at.base, &at.mount, &at.grip}) *port = test::uniformVector(rng, 6, kLarge);
  Sample sample;
  sample.q = test::uniformVector(rng, cell.arm->jointCount(), 1.0);
  const PoseDerivative pose = evaluatePose(state, layout, sample, at);
  const Eigen::Isometry3d T = disturbedTarget(state.cell, sample, at);
  EXPECT_THAT(pose.T_camera_target.matrix(), test::IsNear(T.matrix(), 1e-12));
  for (int k = 0; k < layout.total; ++k) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(layout.total, k);
    const Eigen::Isometry3d ahead = disturbedTarget(state.moved(layout, step).cell, sample, at);
    const Eigen::Isometry3d behind = disturbedTarget(state.moved(layout, -step).cell, sample, at);
    const Vector6d numeric = logSe3(ahead * behind.inverse()) / (2.0 * kStep);
    EXPECT_THAT(Vector6d(pose.M.col(k)), test::IsNear(numeric, 1e-8)) << parameterNames(cell, free)[static_cast<std::size_t>(k)];
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, AdjustmentOf,
                         ::testing::Values(Case{"RRRRRR", Setup::kEyeToHand}, Case{"RRRRRR", Setup::kEyeInHand},
                                           Case{"RRPR", Setup::kEyeToHand}));

TEST(Adjustment, DerivativeOfAPoseMatchesCentralDifferences) {
  constexpr double kStep = 1e-6;
  Rng rng = test::rngOfThisTest();
  Cell cell;
  cell.arm = test::randomArm(rng, "RRR");
  Observation observation;
  observation.q = test::uniformVector(rng, 3, 1.0);
  PoseMeasurement pose;
  pose.T_camera_target = test::randomPose(rng);
  pose.whitening = Matrix6d::Random();
  observation.pose = pose;
  const Eigen::Isometry3d T = test::randomPose(rng);
  SampleRows rows;
  evaluateRows(cell, observation, T, false, rows);
  for (int k = 0; k < 6; ++k) {
    const Vector6d step = kStep * Vector6d::Unit(k);
    SampleRows ahead, behind;
    evaluateRows(cell, observation, expSe3(step) * T, false, ahead);
    evaluateRows(cell, observation, expSe3(-step) * T, false, behind);
    EXPECT_THAT(Eigen::VectorXd(rows.H.col(k)), test::IsNear(Eigen::VectorXd((behind.r - ahead.r) / (2.0 * kStep)), 1e-8));
  }
}

TEST(Adjustment, TrueStartStaysAndDisplacedStartReturns) {
  Rng rng = test::rngOfThisTest();
  const Cell truth = testCell(rng, "RRRRRR", Setup::kEyeToHand);
  const std::vector<Observation> observations = observe(truth, rng, 40, 0.0);
  AdjustmentOptions options;
  options.free = {.near = true, .far = true};
  options.scale = 1.0;
  EXPECT_LT(adjust(truth, observations, options).chi_square, 1e-18);
  Cell start = truth;
  start.registration.T_camera_near = expSe3(test::uniformVector(rng, 6, 0.02)) * start.registration.T_camera_near;
  start.registration.T_far_target = expSe3(test::uniformVector(rng, 6, 0.02)) * start.registration.T_far_target;
  const Adjustment fit = adjust(start, observations, options);
  EXPECT_EQ(fit.status, AdjustmentStatus::kConverged);
  EXPECT_THAT(fit.cell.registration.T_camera_near, test::PoseIsNear(truth.registration.T_camera_near, 1e-10));
  EXPECT_THAT(fit.cell.registration.T_far_target, test::PoseIsNear(truth.registration.T_far_target, 1e-10));
  // Two centimetres and degrees are more than one step.
  options.max_iterations = 1;
  EXPECT_EQ(adjust(start, observations, options).status, AdjustmentStatus::kIterationLimit);
}

TEST(Adjustment, CovarianceIsThatOfTheErrorsAndScaleThatOfTheNoise) {
  constexpr int kSeeds = 60;
  constexpr double kSigma = 0.2;
  Rng rng = test::rngOfThisTest();
  const Cell truth = testCell(rng, "RRRRRR", Setup::kEyeToHand);
  AdjustmentOptions options;
  options.free = {.near = true, .far = true};
  std::vector<double> normalised, scales;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Adjustment fit = adjust(truth, observe(truth, rng, 30, kSigma), options);
    Eigen::VectorXd error(12);
    error << logSe3(fit.cell.registration.T_camera_near * truth.registration.T_camera_near.inverse()),
        logSe3(fit.cell.registration.T_far_target * truth.registration.T_far_target.inverse());
    normalised.push_back(error.dot(fit.covariance.ldlt().solve(error)));
    scales.push_back(fit.scale);
  }
  // The sum of 60 chi-squares with 12 degrees of freedom; the estimated scale (228 degrees of freedom) widens it by less than a per cent.
  const double dof = 12.0 * kSeeds;
  const double sum = mean(normalised) * kSeeds;
  EXPECT_GT(sum, 0.98 * chiSquareQuantile(0.001, dof));
  EXPECT_LT(sum, 1.02 * chiSquareQuantile(0.999, dof));
  EXPECT_NEAR(mean(scales), kSigma, 4.0 * kSigma / std::sqrt(2.0 * 228 * kSeeds));
}

TEST(Adjustment, WildRowsLoseTheirWeightAndDoNotMoveTheFit) {
  Rng rng = test::rngOfThisTest();
  const Cell truth = testCell(rng, "RRRRRR", Setup::kEyeToHand);
  std::vector<Observation> observations = observe(truth, rng, 50, 0.1);
  AdjustmentOptions options;
  options.free = {.near = true, .far = true};
  const Adjustment clean = adjust(truth, observations, options);
  for (std::size_t k = 0; k < 10; ++k) {
    const Eigen::Vector2d shift(30.0 + static_cast<double>(k), -40.0);
    for (CornerMeasurement& corner : observations[5 * k].corners) corner.px += shift;
  }
  const Adjustment fit = adjust(truth, observations, options);
  for (std::size_t k = 0; k < observations.size(); ++k) EXPECT_EQ(fit.weights[k][0] == 0.0, k % 5 == 0) << "row " << k;
  Eigen::VectorXd moved(12);
  moved << logSe3(fit.cell.registration.T_camera_near * clean.cell.registration.T_camera_near.inverse()),
      logSe3(fit.cell.registration.T_far_target * clean.cell.registration.T_far_target.inverse());
  // Two standard deviations, though the fits share four fifths of their data.
  EXPECT_TRUE((moved.cwiseAbs().array() < 2.0 * fit.covariance.diagonal().cwiseSqrt().array()).all()) << moved.transpose();
}

TEST(Adjustment, GammaAndToolTogetherAreSeenAsOneUnknown) {
  Rng rng = test::rngOfThisTest();
  const Cell truth = testCell(rng, "RRRRRR", Setup::kEyeToHand);
  AdjustmentOptions options;
  options.free = {.gamma = true, .far = true};
  const Adjustment fit = adjust(truth, observe(truth, rng, 30, 0.1), options);
  EXPECT_EQ(fit.rank, 6);
  EXPECT_EQ(fit.unseen.size(), 6u);
}

TEST(Adjustment, TooFewNumbersIsSaid) {
  Rng rng = test::rngOfThisTest();
  const Cell truth = testCell(rng, "RRRRRR", Setup::kEyeToHand);
  AdjustmentOptions options;
  options.free = {.near = true, .far = true};
  EXPECT_THROW(adjust(truth, observe(truth, rng, 1, 0.0), options), InsufficientData);
}

}  // namespace
}  // namespace poecal
