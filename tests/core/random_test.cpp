#include "poecal/core/random.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/core/parallel.hpp"

namespace poecal {
namespace {

TEST(Random, FirstFourMomentsOfTheNormal) {
  constexpr int kCount = 200000;
  Rng rng(1);
  double m1 = 0.0, m2 = 0.0, m4 = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const double x = rng.normal();
    m1 += x / kCount;
    m2 += x * x / kCount;
    m4 += x * x * x * x / kCount;
  }
  // Four standard errors: 1/sqrt N, sqrt(2/N), sqrt(96/N).
  EXPECT_NEAR(m1, 0.0, 4.0 / std::sqrt(kCount));
  EXPECT_NEAR(m2, 1.0, 4.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(m4, 3.0, 4.0 * std::sqrt(96.0 / kCount));
}

TEST(Random, SameSeedSameNumbersOtherStreamOtherNumbers) {
  Rng a(7, 3), b(7, 3), c(7, 4);
  int equal = 0;
  for (int k = 0; k < 100; ++k) {
    const double x = a.uniform();
    EXPECT_EQ(x, b.uniform());
    equal += x == c.uniform();
  }
  EXPECT_EQ(equal, 0);
}

TEST(Parallel, EveryItemOnceAndTheLowestErrorWins) {
  std::vector<int> hits(1000, 0);
  parallelFor(hits.size(), 4, [&](std::size_t i) { ++hits[i]; });
  EXPECT_THAT(hits, ::testing::Each(1));
  try {
    parallelFor(1000, 4, [](std::size_t i) {
      if (i % 100 == 37) throw InvalidArgument("item " + std::to_string(i));
    });
    FAIL() << "no error came out";
  } catch (const InvalidArgument& error) {
    EXPECT_STREQ(error.what(), "item 37");
  }
}

}  // namespace
}  // namespace poecal
