// What a plan says while it is made, and that it can be stopped there.
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>

#include "planning/planned_cell.hpp"
#include "planning/pool.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::Not;

struct Told {
  std::size_t done = 0, total = 0;
};

class ProgressOfPlans : public ::testing::TestWithParam<PlanAim> {
 protected:
  static void SetUpTestSuite() { known_ = new test::PlannedCell(test::plannedCell("cobot6", 1, 20)); }
  static void TearDownTestSuite() { delete known_; }

  PlanningCell cell() const {
    PlanningCell cell = test::withEffect(*known_, {"joint_gain", "joint:4", {{"gain", 1.5e-3}}});
    cell.open = {{.explanations = {{"joint_gain", "joint:4", "q4", 0.5}, {"joint_eccentricity", "joint:4", "q4", 0.4}}}};
    return cell;
  }
  PlanOptions options() const {
    PlanOptions options;
    options.aim = GetParam();
    options.count = 4;
    options.candidates = 60;
    options.detect = "joint_gain@joint:2";
    options.detect_size = 1e-4;
    return options;
  }
  static test::PlannedCell* known_;
};
test::PlannedCell* ProgressOfPlans::known_ = nullptr;

TEST_P(ProgressOfPlans, EveryJobGoesOnToItsEnd) {
  PlanOptions told = options();
  std::map<std::string, std::vector<Told>> jobs;
  told.progress = [&jobs](const std::string& label, std::size_t done, std::size_t total) { jobs[label].push_back({done, total}); };
  const Plan plan = planPoses(cell(), told);
  ASSERT_THAT(jobs, Not(IsEmpty()));
  for (const char* label : {"looking for postures that show the target", "choosing poses", "exchanging poses for better ones"}) {
    EXPECT_THAT(jobs, Contains(Key(label)));
  }
  for (const auto& [label, heard] : jobs) {
    EXPECT_EQ(heard.front().done, 0u) << label;
    EXPECT_EQ(heard.back().done, heard.back().total) << label;
    for (std::size_t k = 1; k < heard.size(); ++k) {
      ASSERT_GT(heard[k].total, 0u) << label;
      const bool again = heard[k - 1].done == heard[k - 1].total && heard[k].done == 0;
      EXPECT_TRUE(again || heard[k].done >= heard[k - 1].done) << label << ": " << heard[k].done << " after " << heard[k - 1].done;
    }
  }
  EXPECT_EQ(planCsv(plan, 20), planCsv(planPoses(cell(), options()), 20)) << "a plan is the same whoever listens";
}

TEST_P(ProgressOfPlans, WhoeverListensCanStopItAnywhere) {
  PlanOptions counted = options();
  int calls = 0;
  counted.progress = [&calls](const std::string&, std::size_t, std::size_t) { ++calls; };
  planPoses(cell(), counted);
  for (const int stop_at : {1, calls / 2, calls}) {
    PlanOptions stopped = options();
    int heard = 0;
    stopped.progress = [&](const std::string&, std::size_t, std::size_t) {
      if (++heard >= stop_at) throw std::runtime_error("enough at " + std::to_string(heard));
    };
    EXPECT_THAT([&] { planPoses(cell(), stopped); }, ::testing::ThrowsMessage<std::runtime_error>("enough at " + std::to_string(stop_at)));
  }
}

INSTANTIATE_TEST_SUITE_P(EachAim, ProgressOfPlans, ::testing::Values(PlanAim::kTool, PlanAim::kSeparate, PlanAim::kDetect),
                         [](const auto& each) {
                           return each.param == PlanAim::kTool ? "Tool" : each.param == PlanAim::kSeparate ? "Separate" : "Detect";
                         });

// Where no posture shows the target, a hundred thousand are tried: that too can be stopped.
TEST(ProgressOfPools, IsShownWhileNothingIsFound) {
  const test::PlannedCell known = test::plannedCell("cobot6", 1, 15);
  PlanningCell away = known.cell;
  away.model.cell.registration.T_camera_near.translation().z() = -5.0;
  PlanOptions options;
  options.candidates = 20;
  int shown = 0;
  options.progress = [&shown](const std::string&, std::size_t done, std::size_t total) { shown += done == 0 && total == 20 ? 1 : 0; };
  EXPECT_THROW(planPoses(away, options), InsufficientData);
  EXPECT_EQ(shown, 20);
}

}  // namespace
}  // namespace poecal
