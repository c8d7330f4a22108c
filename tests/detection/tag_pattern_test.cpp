// What is printed on a tag: the quick answer to what lies about a point is the slow one.
#include "detection/tag_pattern.hpp"

#include <gtest/gtest.h>

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
