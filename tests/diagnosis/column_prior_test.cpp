#include "diagnosis/column_prior.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

/// log of the density of b, b + offset ~ N(0, precision^-1).
double logDensity(const ColumnPrior& prior, const Eigen::VectorXd& b) {
  const Eigen::VectorXd off = b + prior.offset;
  return 0.5 * (prior.log_determinant - static_cast<double>(b.size()) * std::log(2.0 * M_PI) - off.dot(prior.precision * off));
}

TEST(ColumnPrior, JoinedColumnsAreIndependent) {
  const ColumnPrior first = ColumnPrior::independent(Eigen::Vector2d(0.5, 2.0), Eigen::Vector2d(0.1, -0.3));
  const ColumnPrior second = ColumnPrior::independent(Eigen::VectorXd::Constant(1, 3.0), Eigen::VectorXd::Constant(1, 0.7));
  const ColumnPrior both = first.joinedWith(second);
  const Eigen::Vector3d b(0.4, 0.2, -1.1);
  EXPECT_NEAR(logDensity(both, b), logDensity(first, b.head(2)) + logDensity(second, b.tail(1)), 1e-12);
  EXPECT_NEAR(both.log_determinant, std::log(both.precision.determinant()), 1e-12);
}

// Bayes' rule itself: prior times likelihood is the integral times what is believed afterwards, at any b.
TEST(ColumnPrior, FurtherRowsFollowBayesRule) {
  Rng rng = test::rngOfThisTest();
  const ColumnPrior prior = ColumnPrior::independent(Eigen::Vector3d(0.5, 2.0, 0.1), Eigen::Vector3d(0.1, -0.3, 0.02));
  Eigen::MatrixXd rows(2, 3);  // fewer rows than columns: one direction is the prior's alone
  for (double& each : rows.reshaped()) each = 3.0 * rng.normal();
  const Eigen::Vector2d seen(0.7, -1.3);
  const Eigen::MatrixXd S = rows.transpose() * rows;
  const Eigen::VectorXd u = rows.transpose() * seen;
  double log_mass = 0.0;
  const ColumnPrior informed = prior.informedBy(S, u, log_mass);
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d b = test::uniformVector(rng, 3, 1.0);
    EXPECT_NEAR(logDensity(prior, b) + u.dot(b) - 0.5 * b.dot(S * b), log_mass + logDensity(informed, b), 1e-9);
  }
}

TEST(ColumnPrior, RowsThatTellNothingChangeNothing) {
  const ColumnPrior prior = ColumnPrior::independent(Eigen::Vector2d(0.5, 2.0), Eigen::Vector2d(0.1, -0.3));
  double log_mass = 1.0;
  const ColumnPrior informed = prior.informedBy(Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero(), log_mass);
  EXPECT_NEAR(log_mass, 0.0, 1e-12);
  EXPECT_TRUE(informed.offset.isApprox(prior.offset, 1e-12));
  EXPECT_TRUE(informed.precision.isApprox(prior.precision, 1e-12));
}

TEST(ColumnPrior, OfTheArmWidensWithTheTolerance) {
  const MeasuredCell measured = test::smallCell(31, 12, 0.1, {}).measured();
  const ModelState state = test::nominalState(measured);
  const ColumnPrior tight = basePrior(measured, state, 1.0), wide = basePrior(measured, state, 3.0);
  const Eigen::Index twists = measured.twists.precision.rows();
  EXPECT_TRUE(tight.precision.topLeftCorner(twists, twists).isApprox(9.0 * wide.precision.topLeftCorner(twists, twists), 1e-12));
  EXPECT_NEAR(tight.log_determinant - wide.log_determinant, 2.0 * static_cast<double>(twists) * std::log(3.0), 1e-9);
  // A nominal cell is where the priors have their middle.
  EXPECT_TRUE(tight.offset.isZero(1e-12));
}

}  // namespace
}  // namespace poecal
