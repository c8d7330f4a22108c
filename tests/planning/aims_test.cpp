#include "planning/aims.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gmock/gmock.h>

#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

constexpr Eigen::Index kUnknowns = 7, kRows = 4;
// Products and inverses of well-conditioned 7 x 7 matrices in doubles.
constexpr double kRounding = 1e-9;

Eigen::MatrixXd randomMatrix(Rng& rng, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd M(rows, columns);
  for (double& x : M.reshaped()) x = rng.normal();
  return M;
}

Eigen::MatrixXd randomInformation(Rng& rng) {
  const Eigen::MatrixXd half = randomMatrix(rng, kUnknowns, kUnknowns);
  return half * half.transpose() + Eigen::MatrixXd::Identity(kUnknowns, kUnknowns);
}

std::vector<WhiteRows> randomPoses(Rng& rng, int count) {
  std::vector<WhiteRows> poses;
  for (int k = 0; k < count; ++k) poses.push_back(randomMatrix(rng, kRows, kUnknowns + 1));
  return poses;
}

std::shared_ptr<const std::vector<WhiteRows>> shared(const std::vector<WhiteRows>& rows) {
  return std::make_shared<const std::vector<WhiteRows>>(rows);
}

TEST(CertaintyAim, CostsWithOnePoseMoreAreThoseOfTheWholeInverse) {
  Rng rng = test::rngOfThisTest();
  const Eigen::MatrixXd information = randomInformation(rng), Q = randomInformation(rng);
  const std::vector<WhiteRows> poses = randomPoses(rng, 5);
  const CertaintyAim mean_variance(information, Q, shared(poses)), volume(information, {}, shared(poses));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::MatrixXd X = poses[k].leftCols(kUnknowns);
    const Eigen::MatrixXd more = information + X.transpose() * X;
    EXPECT_NEAR(mean_variance.costWith(k), (Q * more.inverse()).trace(), kRounding);
    EXPECT_NEAR(volume.costWith(k), -std::log(more.determinant()), kRounding);
  }
}

TEST(CertaintyAim, WhatIsTakenAwayAgainLeavesNothing) {
  Rng rng = test::rngOfThisTest();
  const std::vector<WhiteRows> poses = randomPoses(rng, 2);
  CertaintyAim aim(randomInformation(rng), randomInformation(rng), shared(poses));
  const double before = aim.cost(), with_one = aim.costWith(1);
  aim.add(1);
  EXPECT_NEAR(aim.cost(), with_one, kRounding);
  aim.remove(1);
  EXPECT_NEAR(aim.cost(), before, kRounding);
}

// Against d' S^-1 d of all rows at once, S = I + X Sigma X'.
TEST(ContrastAim, ChiSquareIsThatOfThePredictedRows) {
  Rng rng = test::rngOfThisTest();
  const Eigen::MatrixXd information = randomInformation(rng);
  const std::vector<WhiteRows> poses = randomPoses(rng, 3);
  ContrastAim aim({Contrast{.information = information, .v = Eigen::VectorXd::Zero(kUnknowns), .rows = shared(poses), .log_odds = 0.3}});
  EXPECT_NEAR(aim.cost(), -0.3, kRounding);
  const auto chiSquareOf = [&](int count) {
    Eigen::MatrixXd X(count * kRows, kUnknowns);
    Eigen::VectorXd d(count * kRows);
    for (int k = 0; k < count; ++k) {
      X.middleRows(k * kRows, kRows) = poses[static_cast<std::size_t>(k)].leftCols(kUnknowns);
      d.segment(k * kRows, kRows) = poses[static_cast<std::size_t>(k)].col(kUnknowns);
    }
    const Eigen::MatrixXd S = Eigen::MatrixXd::Identity(d.size(), d.size()) + X * information.inverse() * X.transpose();
    return d.dot(S.inverse() * d);
  };
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(aim.costWith(static_cast<std::size_t>(k)), -0.3 - 0.5 * chiSquareOf(k + 1), kRounding);
    aim.add(static_cast<std::size_t>(k));
    EXPECT_NEAR(aim.chiSquares().front(), chiSquareOf(k + 1), kRounding);
  }
}

/// Of three unknowns, pose k shows k mod 3 with a weight that grows with k.
std::vector<WhiteRows> onePoseForEachUnknown(int count) {
  std::vector<WhiteRows> poses;
  for (int k = 0; k < count; ++k) {
    WhiteRows rows = WhiteRows::Zero(1, 4);
    rows(0, k % 3) = 1.0 + k;
    poses.push_back(rows);
  }
  return poses;
}

TEST(ChoosePoses, TakesTheBestSet) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(3, 3);
  const std::vector<WhiteRows> poses = onePoseForEachUnknown(12);
  CertaintyAim aim(I, I, shared(poses));
  // The three unknowns by themselves: the strongest pose of each.
  EXPECT_THAT(choosePoses(aim, poses.size(), {}, 3, 1, 0.0), ::testing::UnorderedElementsAre(9u, 10u, 11u));
}

TEST(ChoosePoses, ExchangesWhatWasABadStart) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(3, 3);
  const std::vector<WhiteRows> poses = onePoseForEachUnknown(12);
  CertaintyAim aim(I, I, shared(poses));
  EXPECT_THAT(choosePoses(aim, poses.size(), {0, 1, 3}, 3, 1, 0.0), ::testing::UnorderedElementsAre(9u, 10u, 11u));
}

TEST(ChoosePoses, EndsWhereItIsEnoughOrNothingIsLeft) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(3, 3);
  const std::vector<WhiteRows> poses = onePoseForEachUnknown(4);
  CertaintyAim all(I, I, shared(poses)), some(I, I, shared(poses));
  EXPECT_THAT(choosePoses(all, poses.size(), {}, 10, 1, 0.0), ::testing::SizeIs(4));
  EXPECT_THAT(choosePoses(some, poses.size(), {}, 10, 1, 2.5), ::testing::SizeIs(1));  // of a cost of 3, a pose takes off nearly 1
}

// As a greedy choice alone would not: the best set of all, by trying each.
TEST(ChoosePoses, FindsTheBestOfAllPairs) {
  Rng rng = test::rngOfThisTest();
  const Eigen::MatrixXd information = randomInformation(rng), Q = randomInformation(rng);
  const std::vector<WhiteRows> poses = randomPoses(rng, 12);
  CertaintyAim aim(information, Q, shared(poses));
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CertaintyAim with_first(information, Q, shared(poses));
    with_first.add(i);
    for (std::size_t j = i + 1; j < poses.size(); ++j) best = std::min(best, with_first.costWith(j));
  }
  choosePoses(aim, poses.size(), {}, 2, 1, 0.0);
  EXPECT_NEAR(aim.cost(), best, kRounding);
}

}  // namespace
}  // namespace poecal
