// The edge of a model's domain: where the radial profile first stops growing.
#include "camera/distortion.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "camera/growth.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

bool pinholeValidAt(const Eigen::VectorXd& k, double radius) {
  return distortPinhole(k, Eigen::Vector3d(0.6 * radius, 0.8 * radius, 1.0), nullptr).has_value();
}

TEST(Distortion, PinholeEndsBehindTheCamera) {
  const Eigen::VectorXd none;
  EXPECT_TRUE(distortPinhole(none, {0.0, 0.0, 1e-6}, nullptr));
  EXPECT_FALSE(distortPinhole(none, {0.0, 0.0, 0.0}, nullptr));
  EXPECT_FALSE(distortPinhole(none, {0.1, 0.0, -1.0}, nullptr));
  EXPECT_FALSE(distortPinhole(none, {std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0}, nullptr));
  EXPECT_FALSE(distortPinhole(none, {1e300, 0.0, 1e-100}, nullptr));
}

TEST(Distortion, PinholeEndsWhereTheProfileTurns) {
  // r - r^3 / 3: slope 1 - r^2.
  Eigen::VectorXd k = Eigen::VectorXd::Zero(5);
  k(0) = -1.0 / 3.0;
  EXPECT_TRUE(pinholeValidAt(k, 0.9999));
  EXPECT_FALSE(pinholeValidAt(k, 1.0001));
}

TEST(Distortion, PinholeDoesNotReturnWhereTheProfileGrowsAgain) {
  // Slope (1 - s)(1 - s / 4) = 1 - 1.25 s + 0.25 s^2 with s = r^2: positive again beyond r = 2.
  Eigen::VectorXd k = Eigen::VectorXd::Zero(5);
  k(0) = -1.25 / 3.0;
  k(1) = 0.25 / 5.0;
  EXPECT_TRUE(pinholeValidAt(k, 0.9999));
  for (const double radius : {1.0001, 1.5, 2.5, 10.0, 1e6}) EXPECT_FALSE(pinholeValidAt(k, radius)) << radius;
}

TEST(Distortion, RationalEndsAtThePoleOfItsDenominator) {
  // 1 / (1 - s): the slope (1 + s) / (1 - s)^2 is positive on both sides of the pole at r = 1.
  Eigen::VectorXd k = Eigen::VectorXd::Zero(8);
  k(5) = -1.0;
  EXPECT_TRUE(pinholeValidAt(k, 0.9999));
  EXPECT_FALSE(pinholeValidAt(k, 1.0001));
  EXPECT_FALSE(pinholeValidAt(k, 2.0));
}

TEST(Distortion, RationalThatSaturatesTurns) {
  // r / (1 + s): slope (1 - s) / (1 + s)^2.
  Eigen::VectorXd k = Eigen::VectorXd::Zero(8);
  k(5) = 1.0;
  EXPECT_TRUE(pinholeValidAt(k, 0.9999));
  EXPECT_FALSE(pinholeValidAt(k, 1.0001));
}

TEST(Distortion, EquidistantEndsWhereTheProfileTurns) {
  // a - a^3 / 12: slope 1 - a^2 / 4, zero at 2 rad (115 degrees).
  Eigen::VectorXd k = Eigen::VectorXd::Zero(4);
  k(0) = -1.0 / 12.0;
  const auto valid_at = [&k](double angle) { return distortEquidistant(k, {std::sin(angle), 0.0, std::cos(angle)}, nullptr).has_value(); };
  EXPECT_TRUE(valid_at(1.9999));
  EXPECT_FALSE(valid_at(2.0001));
  EXPECT_FALSE(distortEquidistant(Eigen::VectorXd::Zero(4), {0.0, 0.0, -1.0}, nullptr));
  EXPECT_TRUE(distortEquidistant(Eigen::VectorXd::Zero(4), {1e-3, 0.0, -1.0}, nullptr));
}

TEST(Growth, PositiveUpToAgreesWithADenseScan) {
  Rng rng = test::rngOfThisTest();
  int positive = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::array<double, 7> c{1.0};
    for (std::size_t k = 1; k < c.size(); ++k) c[k] = rng.uniform(-4.0, 4.0);
    const double end = rng.uniform(0.2, 2.0);
    double least = 1.0;
    for (int step = 0; step <= 1000; ++step) {
      const double s = end * step / 1000.0;
      double value = 0.0;
      for (std::size_t k = c.size(); k-- > 0;) value = value * s + c[k];
      least = std::min(least, value);
    }
    if (std::abs(least) < 1e-3) continue;  // the scan itself is not finer than that
    EXPECT_EQ(positiveUpTo(c, end), least > 0.0) << "trial " << trial << ", least " << least;
    positive += least > 0.0 ? 1 : 0;
  }
  EXPECT_GT(positive, 50);
  EXPECT_LT(positive, 250);
  EXPECT_FALSE(positiveUpTo(std::array<double, 2>{1.0, 0.0}, std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace
}  // namespace poecal
