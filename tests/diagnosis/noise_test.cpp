#include "diagnosis/noise.hpp"

#include <gmock/gmock.h>

#include "poecal/core/random.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

/// Rows of `poses` poses of four numbers, without an arm: two columns of a base model and two components, each number by itself and what a
/// pose has in common.
struct Rows {
  CaptureRows rows;
  std::vector<NoiseComponent> components{{.name = "number", .start = 1.0, .Z = {}}, {.name = "pose", .start = 1.0, .Z = {}}};
};

Rows makeRows(int poses, double number_sigma, double pose_sigma, Rng& rng) {
  constexpr int kNumbers = 4;
  Rows made;
  made.rows.r.resize(kNumbers * poses);
  made.rows.J.resize(kNumbers * poses, 2);
  for (int g = 0; g < poses; ++g) {
    const double common = pose_sigma * rng.normal();
    for (int i = 0; i < kNumbers; ++i) {
      const int row = kNumbers * g + i;
      made.rows.J(row, 0) = rng.normal();
      made.rows.J(row, 1) = rng.normal();
      made.rows.r(row) = common + number_sigma * rng.normal() + made.rows.J.row(row).dot(Eigen::Vector2d(0.3, -0.7));
    }
    ObservationRows part;
    part.begin = kNumbers * g;
    part.size = kNumbers;
    made.rows.observations.push_back(part);
    made.rows.groups.push_back({static_cast<std::size_t>(g)});
    made.components[0].Z.push_back(Eigen::MatrixXd::Identity(kNumbers, kNumbers));
    made.components[1].Z.push_back(Eigen::MatrixXd::Ones(kNumbers, 1));
  }
  return made;
}

/// Dense second formula: -1/2 (log |C| + log |X'C^-1X| + r'Pr).
double denseLikelihood(const Rows& made, const Eigen::Vector2d& theta) {
  const Eigen::Index n = made.rows.r.size();
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t g = 0; g < made.rows.groups.size(); ++g) {
    const auto begin = static_cast<Eigen::Index>(4 * g);
    C.block(begin, begin, 4, 4) = theta(0) * Eigen::Matrix4d::Identity() + theta(1) * Eigen::Matrix4d::Ones();
  }
  const Eigen::MatrixXd Ci = C.inverse();
  const Eigen::MatrixXd A = made.rows.J.transpose() * Ci * made.rows.J;
  const Eigen::MatrixXd P = Ci - Ci * made.rows.J * A.inverse() * made.rows.J.transpose() * Ci;
  return -0.5 * (std::log(C.determinant()) + std::log(A.determinant()) + made.rows.r.dot(P * made.rows.r));
}

TEST(Noise, LikelihoodIsThatOfTheDenseFormula) {
  Rng rng(1);
  const Rows made = makeRows(12, 0.5, 0.8, rng);
  const Eigen::Vector2d here(0.3, 0.5), there(0.6, 0.2);
  const auto at = [&](const Eigen::Vector2d& theta) {
    return likelihoodsAt(made.rows, made.components, theta, Eigen::MatrixXd(made.rows.size(), 0), {ColumnPrior::none(2)})
        .front()
        .log_likelihood;
  };
  // Rounding of sums of 48 terms of order one.
  EXPECT_NEAR(at(here) - at(there), denseLikelihood(made, here) - denseLikelihood(made, there), 1e-8);
}

TEST(Noise, WhiteNoiseMayBeSummedUpBeyondWhatPosesShare) {
  Rng rng(4);
  Rows made = makeRows(40, 0.5, 0.8, rng);
  const Eigen::MatrixXd none(made.rows.size(), 0);
  const NoiseEstimate in_full = estimateNoise({}, {}, made.rows, made.components, none, ColumnPrior::none(2), nullptr);
  made.components[0].white = true;
  const NoiseEstimate summed = estimateNoise({}, {}, made.rows, made.components, none, ColumnPrior::none(2), nullptr);
  // Rounding of the same steps.
  constexpr double kRounding = 1e-9;
  EXPECT_NEAR(summed.log_likelihood, in_full.log_likelihood, kRounding);
  EXPECT_NEAR(summed.misfit, in_full.misfit, kRounding);
  EXPECT_THAT(summed.theta, test::IsNear(in_full.theta, kRounding));
  EXPECT_THAT(summed.b, test::IsNear(in_full.b, kRounding));
  EXPECT_THAT(summed.covariance, test::IsNear(in_full.covariance, kRounding));
}

TEST(Noise, VariancesAreThoseDrawn) {
  Rng rng(2);
  // 400 poses: the pose's variance is known to sqrt(2 / 400) = 7 %, the number's to 4 %; three times that.
  const Rows made = makeRows(400, 0.5, 0.8, rng);
  MeasuredCell measured;
  measured.free = {.near = false};
  ModelState state;
  Rows without_base = made;
  without_base.rows.J.resize(made.rows.r.size(), 0);
  const NoiseEstimate estimate =
      estimateNoise(measured, state, without_base.rows, made.components, made.rows.J, ColumnPrior::none(2), nullptr);
  EXPECT_NEAR(estimate.theta(0), 0.25, 0.12 * 0.25);
  EXPECT_NEAR(estimate.theta(1), 0.64, 0.21 * 0.64);
  EXPECT_NEAR(estimate.b(0), 0.3, 4.0 * std::sqrt(estimate.covariance(0, 0)));
  EXPECT_NEAR(estimate.b(1), -0.7, 4.0 * std::sqrt(estimate.covariance(1, 1)));
}

TEST(Noise, NothingInCommonComesOutAsNothing) {
  Rng rng(3);
  const Rows made = makeRows(400, 0.5, 0.0, rng);
  Rows without_base = made;
  without_base.rows.J.resize(made.rows.r.size(), 0);
  const NoiseEstimate estimate = estimateNoise({}, {}, without_base.rows, made.components, made.rows.J, ColumnPrior::none(2), nullptr);
  EXPECT_LT(estimate.theta(1), 0.02);  // three standard deviations of a variance of 0.25 / 4 over 400 poses
}

}  // namespace
}  // namespace poecal
