#include <gmock/gmock.h>

#include "cell/linearisation.hpp"
#include "identification/simulated_cell.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

using test::plainBundle;
using test::Simulated;
using test::simulated;

class BundleOf : public ::testing::TestWithParam<const char*> {};

// 20 seeds, 60 poses at 0.1 px: errors at unseen poses against what the covariance predicts for them, and the noise against what it was.
TEST_P(BundleOf, ErrorsAtUnseenPosesAreThoseThatTheCovariancePredicts) {
  constexpr int kSeeds = 20;
  double predicted = 0.0, seen = 0.0;
  std::vector<double> reduced;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Simulated data = simulated(GetParam(), seed, 60, 30);
    const Identification found = identify(data.nominal, data.measurements(), plainBundle());
    reduced.push_back(found.reduced_chi_square);
    for (const Observation& observation : data.unseen) {
      SampleRows rows;  // exact corners: what is left is the model's error
      evaluateRows(found.model.cell, observation, modelTarget(found.model.cell, observation), false, rows);
      const Matrix6d covariance = targetPoseCovariance(found.adjustment, found.start, found.free, observation);
      predicted += (rows.H * covariance * rows.H.transpose()).trace();
      seen += rows.r.squaredNorm();
    }
  }
  EXPECT_NEAR(std::sqrt(seen / predicted), 1.0, 0.10) << "rms error / predicted";
  EXPECT_GT(*std::min_element(reduced.begin(), reduced.end()), 0.7);
  EXPECT_GT(mean(reduced), 0.95);
  EXPECT_LT(mean(reduced), 1.05);
}

INSTANTIATE_TEST_SUITE_P(Arms, BundleOf, ::testing::Values("puma560", "cobot6", "arm7", "scara"));

}  // namespace
}  // namespace poecal
