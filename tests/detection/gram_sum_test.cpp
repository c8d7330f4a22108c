// Sums of outer products against the product of matrices.
#include "detection/gram_sum.hpp"

#include <gmock/gmock.h>

#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

TEST(GramSum, IsTheProductOfAMatrixWithItsTranspose) {
  constexpr double kTolerance = 1e-12;  // rounding of 200 terms of about 1
  Rng rng = test::rngOfThisTest();
  GramSum<6, 3> sum;
  // None, less than a block, blocks that are just full, and more: each time from nothing.
  for (const int count : {0, 1, 63, 64, 65, 200}) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> columns(6, count);
    for (double& value : columns.reshaped()) value = rng.normal();
    for (int k = 0; k < count; ++k) sum.next() = columns.col(k);
    EXPECT_THAT(sum.take(), test::IsNear((columns * columns.transpose()).eval(), kTolerance)) << count;
  }
}

}  // namespace
}  // namespace poecal
