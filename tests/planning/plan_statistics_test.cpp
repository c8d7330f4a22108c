// Plans over many seeds: that they need half the poses, and that the pictures which follow make the tool as certain as they said.
#include <cmath>

#include <gmock/gmock.h>

#include "planning/planned_cell.hpp"

namespace poecal {
namespace {

constexpr int kSeeds = 20, kBefore = 15, kPlanned = 12;

class PlanOf : public ::testing::TestWithParam<const char*> {};

TEST_P(PlanOf, NeedsHalfThePosesOfRandomVisibleOnes) {
  int half = 0;
  double planned = 0.0, random = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const test::PlannedCell known = test::plannedCell(GetParam(), seed, kBefore);
    PlanOptions options;
    options.count = kPlanned;
    options.seed = seed;
    if (const char* c = std::getenv("CAND")) options.candidates = std::atoi(c);
    const Plan plan = planPoses(known.cell, options);
    const int needed = plan.random_poses.value_or(plan.random_tried);
    half += needed >= 2 * kPlanned ? 1 : 0;
    planned += kPlanned;
    random += needed;
  }
  std::printf("%s: %d of 20 seeds half, random %.1f per planned pose\n", GetParam(), half, random / planned);
  EXPECT_EQ(half, kSeeds);
}

TEST_P(PlanOf, ThePicturesThatFollowMakeTheToolAsCertainAsItSaid) {
  double predicted = 0.0, seen = 0.0, before_predicted = 0.0, before_seen = 0.0, random = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const test::PlannedCell known = test::plannedCell(GetParam(), seed, kBefore);
    PlanOptions options;
    options.count = kPlanned;
    options.seed = seed;
    if (const char* c = std::getenv("CAND")) options.candidates = std::atoi(c);
    const Plan plan = planPoses(known.cell, options);
    const auto square = [](double x) { return x * x; };
    before_predicted += square(plan.before.position);
    before_seen += square(test::toolError(known));
    predicted += square(plan.after.position);
    seen += square(test::toolError(test::withPictures(known, plan.poses, seed)));
    random += square(test::toolError(test::withPictures(known, test::randomPoses(GetParam(), 300 + seed, 2 * kPlanned), seed)));
  }
  std::printf("%s: before %.3f, after %.3f of predicted; planned / twice as many random %.3f\n", GetParam(),
              std::sqrt(before_seen / before_predicted), std::sqrt(seen / predicted), std::sqrt(seen / random));
  EXPECT_NEAR(std::sqrt(seen / predicted), 1.0, 0.25) << "rms error / predicted";
  EXPECT_LT(std::sqrt(seen / random), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Arms, PlanOf, ::testing::Values("puma560", "cobot6", "arm7", "scara"));

}  // namespace
}  // namespace poecal
