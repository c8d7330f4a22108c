// Plans over many seeds: how many random poses they stand for, and that the pictures which follow make the tool as certain as they said.
#include <cmath>

#include <gmock/gmock.h>

#include "planning/aims.hpp"
#include "planning/planned_cell.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

constexpr int kSeeds = 20, kBefore = 15;

double square(double x) { return x * x; }

Plan planned(const PlanningCell& cell, std::uint64_t seed, int count) {
  PlanOptions options;
  options.count = count;
  options.seed = seed;
  return planPoses(cell, options);
}

class PlanOf : public ::testing::TestWithParam<const char*> {};

// Half the poses: in the mean of 20 seeds, random visible poses need twice as many for the same uncertainty of the tool.
TEST_P(PlanOf, NeedsHalfThePosesOfRandomVisibleOnes) {
  constexpr int kPlanned = 6;
  int random = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Plan plan = planned(test::plannedCell(GetParam(), seed, kBefore).cell, seed, kPlanned);
    random += plan.random_poses.value_or(plan.random_tried);
  }
  EXPECT_GE(random, 2 * kPlanned * kSeeds);
  RecordProperty("random_poses_per_planned_pose", std::to_string(static_cast<double>(random) / (kPlanned * kSeeds)));
}

// The capture that follows: the true error of the tool over the workspace, against what the plan said and against twice as many random
// poses.
TEST_P(PlanOf, PicturesThatFollowMakeTheToolAsCertainAsItSaid) {
  constexpr int kPlanned = 12;
  double predicted = 0.0, seen = 0.0, random = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const test::PlannedCell known = test::plannedCell(GetParam(), seed, kBefore);
    const Plan plan = planned(known.cell, seed, kPlanned);
    predicted += square(plan.after.position);
    seen += square(test::toolError(test::withPictures(known, plan.poses, seed)));
    random += square(test::toolError(test::withPictures(known, test::randomPoses(GetParam(), 300 + seed, 2 * kPlanned), seed)));
  }
  // The error of one seed is a few independent numbers, of which the two largest rule: 20 seeds tell an rms to 1 / sqrt(2 * 20 * 2) = 11 %,
  // and a ratio of two to 16 %. Two of those.
  EXPECT_NEAR(std::sqrt(seen / predicted), 1.0, 0.22) << "rms error / predicted";
  EXPECT_LT(std::sqrt(seen / random), 1.32) << "rms error / that with twice as many random poses";
  RecordProperty("error_by_predicted", std::to_string(std::sqrt(seen / predicted)));
  RecordProperty("error_by_twice_as_many_random", std::to_string(std::sqrt(seen / random)));
}

/// Two explanations of one joint's error, equally likely so far, of which the first is right.
struct Case {
  EffectSpec right;
  Rival wrong;
};

// A third of the poses for odds of 20 : 1 either way.
TEST_P(PlanOf, TellsRivalsApartInAThirdOfThePosesThatRandomOnesNeed) {
  constexpr int kFewSeeds = 5;
  const std::vector<Case> cases{
      {{"joint_gain", "joint:2", {{"gain", 1.5e-3}}}, {"joint_eccentricity", "joint:2", "q2", 0.5}},
      {{"joint_eccentricity", "joint:4", {{"sine", 4e-4}, {"cosine", 2e-4}}}, {"joint_gain", "joint:4", "q4", 0.5}},
  };
  int planned_poses = 0, random = 0;
  for (std::uint64_t seed = 1; seed <= kFewSeeds; ++seed) {
    const test::PlannedCell known = test::plannedCell(GetParam(), seed, kBefore);
    for (const Case& each : cases) {
      PlanningCell cell = test::withEffect(known, each.right);
      const std::string driver = cell.model.effects.front().effect.driver().name();
      cell.open = {{.explanations = {{each.right.effect, each.right.location, driver, 0.5}, each.wrong}}};
      PlanOptions options;
      options.aim = PlanAim::kSeparate;
      options.seed = seed;
      const Plan plan = planPoses(cell, options);
      planned_poses += static_cast<int>(plan.poses.size());
      random += plan.random_poses.value_or(plan.random_tried);
    }
  }
  EXPECT_GE(random, 3 * planned_poses);
  RecordProperty("random_poses_per_planned_pose", std::to_string(static_cast<double>(random) / planned_poses));
}

/// Least squares of one explanation with all that is believed: what its likelihood falls with.
double misfit(const PlanningCell& cell, const AppliedEffect& explanation) {
  const Candidate candidate = modelCandidate(explanation);
  const Knowledge knowledge(cell, {}, {{candidate, 10.0 * candidate.typical}});
  const ColumnPrior prior = knowledge.prior();
  Eigen::MatrixXd information = prior.precision;
  Eigen::VectorXd g = -prior.precision * prior.offset;
  double squares = prior.offset.dot(prior.precision * prior.offset);
  for (const WhiteRows& rows : knowledge.taken()) {
    const Eigen::MatrixXd X = rows.leftCols(information.cols());
    const Eigen::VectorXd r = rows.rightCols<1>();
    information += X.transpose() * X;
    g += X.transpose() * r;
    squares += r.squaredNorm();
  }
  return squares - g.dot(covarianceOf(information) * g);
}

// What the pictures of a plan do to the odds: the log-likelihoods of both explanations before and after, against what was expected.
TEST(PlanToSeparate, OddsChangeAsExpected) {
  double expected = 0.0, seen = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const test::PlannedCell known = test::plannedCell("cobot6", seed, kBefore);
    const EffectSpec right{"joint_gain", "joint:4", {{"gain", 1.5e-3}}}, wrong{"joint_eccentricity", "joint:4", {}};
    PlanningCell cell = test::withEffect(known, right);
    cell.open = {{.explanations = {{"joint_gain", "joint:4", "q4", 0.5}, {"joint_eccentricity", "joint:4", "q4", 0.5}}}};
    PlanOptions options;
    options.aim = PlanAim::kSeparate;
    options.seed = seed;
    options.odds = 1e6;
    const Plan plan = planPoses(cell, options);
    expected += std::log(plan.odds.front().expected / plan.odds.front().before);
    PlanningCell after = cell;
    test::addPictures(known.truth, right, plan.poses, seed, after);
    const AppliedEffect a = cell.model.effects.front(), b = makeEffect(wrong, cell.model.cell);
    seen += 0.5 * ((misfit(after, b) - misfit(cell, b)) - (misfit(after, a) - misfit(cell, a)));
  }
  // Log odds of expectation E scatter by sqrt(2 E), at odds of 1e6 by 40 %, over 20 seeds by 9 %; and the same again since what is expected
  // hangs on factors that 15 poses tell.
  EXPECT_NEAR(seen / expected, 1.0, 0.26);
  RecordProperty("seen_by_expected", std::to_string(seen / expected));
}

INSTANTIATE_TEST_SUITE_P(Arms, PlanOf, ::testing::Values("puma560", "cobot6", "arm7", "scara"));

}  // namespace
}  // namespace poecal
