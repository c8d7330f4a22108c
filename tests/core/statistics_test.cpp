#include "poecal/core/statistics.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/core/random.hpp"

namespace poecal {
namespace {

TEST(Statistics, MedianAndQuantiles) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_EQ(quantile({0.0, 10.0}, 0.25), 2.5);
  EXPECT_THROW(median({}), InvalidArgument);
}

TEST(Statistics, RobustSigmaOfANormalSampleWithWildValues) {
  Rng rng(5);
  std::vector<double> sample;
  for (int k = 0; k < 20000; ++k) sample.push_back(2.0 * rng.normal());
  // The standard error of the MAD estimate is 1.17 sigma / sqrt(N); four of them.
  EXPECT_NEAR(robustSigma(sample), 2.0, 4.0 * 1.17 * 2.0 / std::sqrt(20000.0));
  for (int k = 0; k < 2000; ++k) sample[static_cast<std::size_t>(k)] = 1e6;
  EXPECT_LT(robustSigma(sample), 2.5);
}

TEST(Statistics, RankCorrelationKnowsOrderAlone) {
  EXPECT_NEAR(rankCorrelation({1.0, 2.0, 4.0, 8.0}, {-3.0, 0.0, 0.1, 100.0}), 1.0, 1e-15);
  EXPECT_NEAR(rankCorrelation({1.0, 2.0, 4.0, 8.0}, {5.0, 4.0, 3.0, 2.0}), -1.0, 1e-15);
  // Two equal values share ranks 2 and 3: 8 / sqrt(10 * 9.5).
  EXPECT_NEAR(rankCorrelation({1.0, 2.0, 3.0, 4.0, 5.0}, {5.0, 6.0, 7.0, 8.0, 7.0}), 8.0 / std::sqrt(95.0), 1e-15);
  EXPECT_EQ(rankCorrelation({1.0, 2.0}, {3.0, 3.0}), 0.0);
  EXPECT_THROW(rankCorrelation({1.0}, {1.0, 2.0}), InvalidArgument);
  EXPECT_EQ(rankCorrelation({}, {}), 0.0);
}

// Values from the tables of Abramowitz and Stegun (26.8, 26.9, 26.10).
TEST(Statistics, TailsMatchPrintedTables) {
  EXPECT_NEAR(chiSquareTail(3.84146, 1), 0.05, 1e-6);
  EXPECT_NEAR(chiSquareTail(23.2093, 10), 0.01, 1e-6);
  EXPECT_NEAR(chiSquareQuantile(0.99, 10), 23.2093, 1e-4);
  EXPECT_NEAR(fTail(2.97823, 10, 10), 0.05, 1e-6);
  EXPECT_NEAR(studentQuantile(0.975, 10), 2.22814, 1e-5);
  EXPECT_NEAR(normalQuantile(0.975), 1.959964, 1e-6);
}

TEST(Statistics, WilsonIntervalOfNoHits) {
  const auto [lower, upper] = wilsonInterval(0, 100);
  EXPECT_NEAR(lower, 0.0, 1e-15);
  const double z2 = 1.959964 * 1.959964;
  EXPECT_NEAR(upper, z2 / (100.0 + z2), 1e-6);  // closed form for p = 0
}

}  // namespace
}  // namespace poecal
