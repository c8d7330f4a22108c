// What is printed on a tag: the quick answer to what lies about a point is the slow one.
#include "detection/tag_pattern.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "poecal/core/error.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

TEST(TagPattern, WhatIsUniformAboutAPointIsUniformInTheBoxAboutIt) {
  Rng rng = test::rngOfThisTest();
  const TagPattern pattern("tag36h11", 17, true);
  int uniform = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Vector2d uv(rng.uniform(0.0, pattern.width()), rng.uniform(0.0, pattern.width()));
    const Eigen::Vector2d reach(rng.uniform(0.0, 0.99), rng.uniform(0.0, 0.99));
    ASSERT_EQ(pattern.isUniformAbout(uv, reach), pattern.isUniform(uv - reach, uv + reach)) << uv.transpose() << ", " << reach.transpose();
    uniform += pattern.isUniformAbout(uv, reach);
    EXPECT_FALSE(pattern.isUniformAbout(uv, {reach.x(), 1.0})) << "cells beyond the neighbours are not in the table";
  }
  EXPECT_GT(uniform, 200);
  EXPECT_LT(uniform, 1800);
}

TEST(TagPattern, AWideBorderIsOneMoreRingOfBlack) {
  const TagPattern narrow("tag36h11", 17, true), wide("tag36h11", 17, true, 2);
  ASSERT_EQ(wide.width(), narrow.width() + 2);
  for (int row = 0; row < wide.width(); ++row) {
    for (int column = 0; column < wide.width(); ++column) {
      const int ring = std::min({row, column, wide.width() - 1 - row, wide.width() - 1 - column});
      const int expected = ring == 0 ? 1 : ring <= 2 ? 0 : narrow.white(column - 1, row - 1);
      EXPECT_EQ(wide.white(column, row), expected) << column << ", " << row;
    }
  }
  EXPECT_EQ(wide.corners()(0, 1) - wide.corners()(0, 0), 10.0);
  EXPECT_EQ(wide.corners().rowwise().mean(), Eigen::Vector2d(6.0, 6.0));
  EXPECT_THROW(TagPattern("tagStandard41h12", 1, true, 2), InvalidArgument);
}

TEST(TagPattern, ContainsWhatLiesInItsCells) {
  const TagPattern pattern("tag36h11", 17, true);
  EXPECT_TRUE(pattern.contains({0.0, 0.0}));
  EXPECT_TRUE(pattern.contains({9.99, 9.99}));
  EXPECT_FALSE(pattern.contains({-0.01, 5.0}));
  EXPECT_FALSE(pattern.contains({5.0, 10.0}));
  EXPECT_FALSE(pattern.contains({1e9, 5.0}));
}

}  // namespace
}  // namespace poecal
