#include "poecal/capture/row_order.hpp"

#include <gmock/gmock.h>

namespace poecal {
namespace {

std::vector<Sample> rows() {
  std::vector<Sample> samples(4);
  samples[0].q = Eigen::Vector2d(0.1, 0.5);
  samples[1].q = Eigen::Vector2d(0.3, 0.5);
  samples[2].q = Eigen::Vector2d(-0.2, 0.4);
  samples[3].q = Eigen::Vector2d(-0.2, 0.9);
  return samples;
}

TEST(RowOrder, StandsInForStampAndSides) {
  std::vector<Sample> samples = rows();
  const RowOrder order = standInByRowOrder(samples);
  EXPECT_TRUE(order.stamp);
  EXPECT_TRUE(order.dir);
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_EQ(samples[i].stamp, static_cast<double>(i));
  EXPECT_EQ(samples[0].dir, Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(samples[1].dir, Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(samples[2].dir, Eigen::Vector2d(-1.0, -1.0));
  EXPECT_EQ(samples[3].dir, Eigen::Vector2d(-1.0, 1.0));
}

TEST(RowOrder, LeavesWhatWasRecorded) {
  std::vector<Sample> samples = rows();
  samples[1].stamp = 7.0;
  for (Sample& sample : samples) sample.dir = Eigen::Vector2d(-1.0, -1.0);
  const RowOrder order = standInByRowOrder(samples);
  EXPECT_FALSE(order.stamp);
  EXPECT_FALSE(order.dir);
  EXPECT_FALSE(samples[0].stamp.has_value());
  EXPECT_EQ(samples[2].dir, Eigen::Vector2d(-1.0, -1.0));
}

TEST(RowOrder, OfNothingIsNothing) {
  std::vector<Sample> samples;
  EXPECT_FALSE(standInByRowOrder(samples).stamp);
}

}  // namespace
}  // namespace poecal
