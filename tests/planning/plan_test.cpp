#include "poecal/planning/plan.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "planning/planned_cell.hpp"
#include "planning/pool.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

PlanOptions few() {
  PlanOptions options;
  options.count = 6;
  options.candidates = 200;
  return options;
}

class PlanOfCobot : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { known_ = new test::PlannedCell(test::plannedCell("cobot6", 1, 20)); }
  static void TearDownTestSuite() { delete known_; }
  static test::PlannedCell* known_;
};
test::PlannedCell* PlanOfCobot::known_ = nullptr;

// A second way to the same figure: the covariance that the bundle adjustment itself gives.
TEST_F(PlanOfCobot, UncertaintyIsThatOfTheAdjustment) {
  const Identification& found = known_->identification;
  const PlanOptions options;
  double position = 0.0, rotation = 0.0;
  const std::vector<Sample> workspace = Pool(known_->cell, options).anywhere(200);
  for (const Sample& sample : workspace) {
    Observation at;
    at.q = sample.q;
    const Matrix6d covariance = targetPoseCovariance(found.adjustment, found.start, found.free, at);
    const Eigen::Vector3d p = found.model.cell.registration.cameraTarget(forwardKinematics(*found.model.cell.arm, sample.q)).translation();
    Eigen::Matrix<double, 3, 6> J;  // of the target's origin by a left perturbation in camera
    J << -hat(p), Eigen::Matrix3d::Identity();
    position += (J * covariance * J.transpose()).trace() / 200.0;
    rotation += covariance.topLeftCorner<3, 3>().trace() / 200.0;
  }
  PlanningCell cell = known_->cell;
  cell.noise.corner = found.scale * test::kSigma;  // as the fit estimated it
  const ToolUncertainty tool = toolUncertainty(cell, {});
  // A robust fit gives no corner here less weight; the two differ by the priors of 1 m and 1 rad that a plan has on both transforms.
  EXPECT_NEAR(tool.position / std::sqrt(position), 1.0, 0.01);
  EXPECT_NEAR(tool.rotation / std::sqrt(rotation), 1.0, 0.01);
}

TEST_F(PlanOfCobot, BringsWhatItSaysAndMoreThanRandomPoses) {
  const Plan plan = planPoses(known_->cell, few());
  ASSERT_THAT(plan.poses, SizeIs(6));
  EXPECT_LT(plan.after.position, plan.before.position);
  EXPECT_NEAR(plan.before.position, toolUncertainty(known_->cell, {}).position, 1e-12);
  std::vector<Sample> samples;
  for (const PlannedPose& pose : plan.poses) samples.emplace_back().q = pose.q;
  EXPECT_NEAR(plan.after.position, toolUncertainty(known_->cell, samples).position, 1e-9 * plan.after.position);
  ASSERT_TRUE(plan.random_poses);
  EXPECT_GE(*plan.random_poses, 12);
}

TEST_F(PlanOfCobot, IsTheSameWhateverTheNumberOfThreads) {
  PlanOptions options = few();
  const Plan one = planPoses(known_->cell, options);
  options.jobs = 3;
  const Plan three = planPoses(known_->cell, options);
  EXPECT_EQ(planCsv(one, 20), planCsv(three, 20));
}

TEST_F(PlanOfCobot, SmallestVolumeIsAnotherPlan) {
  PlanOptions options = few();
  const Plan mean = planPoses(known_->cell, options);
  options.criterion = PlanCriterion::kD;
  const Plan volume = planPoses(known_->cell, options);
  // Each is best by its own measure; the tool is what A is about.
  EXPECT_LT(mean.after.position, volume.after.position);
  EXPECT_LT(volume.after.position, volume.before.position);
}

TEST_F(PlanOfCobot, SidesAreThoseOfTheStraightWay) {
  const Plan plan = planPoses(known_->cell, few());
  EXPECT_FALSE(plan.sides_matter);
  Eigen::VectorXd at = known_->cell.taken.samples.back().q;
  for (const PlannedPose& pose : plan.poses) {
    EXPECT_EQ(pose.dir, Eigen::VectorXd((pose.q - at).cwiseSign()));
    at = pose.q;
  }
}

TEST_F(PlanOfCobot, PosesForAnEffectShowItBetter) {
  PlanOptions options = few();
  options.aim = PlanAim::kDetect;
  options.detect = "joint_coupling@joint:6/q5";
  options.detect_size = 5e-4;
  const Plan plan = planPoses(known_->cell, options);
  options.aim = PlanAim::kTool;
  ASSERT_TRUE(plan.detection_before && plan.detection_after);
  EXPECT_GT(plan.detection_after->chi_square, 2.0 * plan.detection_before->chi_square);
  EXPECT_GT(plan.detection_after->probability, plan.detection_before->probability);
  EXPECT_GT(plan.random_poses.value_or(plan.random_tried), 12);
}

// The expected chi-square grows with the square of the size, and an expected 36 is found four times in five.
TEST_F(PlanOfCobot, DetectionIsOfTheSizeAskedFor) {
  PlanOptions options = few();
  options.aim = PlanAim::kDetect;
  options.detect = "joint_gain@joint:3";
  options.detect_size = 1e-4;
  const Detection small = *planPoses(known_->cell, options).detection_before;
  options.detect_size *= 6.0 / std::sqrt(small.chi_square);
  const Detection limit = *planPoses(known_->cell, options).detection_before;
  EXPECT_NEAR(limit.chi_square, 36.0, 1e-6);
  EXPECT_NEAR(limit.probability, 0.8, 1e-6);
}

TEST_F(PlanOfCobot, BacklashNeedsSides) {
  PlanOptions options = few();
  options.aim = PlanAim::kDetect;
  options.detect = "joint_backlash@joint:2";
  options.detect_size = 2e-4;
  EXPECT_TRUE(planPoses(known_->cell, options).sides_matter);
}

TEST_F(PlanOfCobot, WrongQuestionsAreNamed) {
  const auto messageOf = [&](const std::string& detect) -> std::string {
    PlanOptions options = few();
    options.aim = PlanAim::kDetect;
    options.detect = detect;
    options.detect_size = 1e-3;
    try {
      planPoses(known_->cell, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(messageOf("joint_coupling"), HasSubstr("expected one like joint_coupling@joint:6"));
  EXPECT_THAT(messageOf("wobble@joint:6"), HasSubstr("wobble"));
  EXPECT_THAT(messageOf("joint_coupling@joint:9"), HasSubstr("expected one of: joint:1/q2"));
  EXPECT_THAT(messageOf("joint_scatter@joint:1"), HasSubstr("random"));
  EXPECT_THAT(messageOf("rolling_shutter@camera.shutter"), HasSubstr("cannot be planned for: no dq1.. columns"));
}

// A thousand million candidates would fill any memory before the first is weighed.
TEST_F(PlanOfCobot, CandidatesHaveABound) {
  PlanOptions options = few();
  options.candidates = 1'000'000'000;
  EXPECT_THAT([&] { planPoses(known_->cell, options); },
              ThrowsMessage<InvalidArgument>(HasSubstr("candidates is 1000000000, expected at most")));
}

TEST_F(PlanOfCobot, NothingInViewSaysWhatToChange) {
  PlanningCell away = known_->cell;
  away.model.cell.registration.T_camera_near =
      Eigen::Isometry3d(Eigen::Translation3d(0, 0, -5.0)) * away.model.cell.registration.T_camera_near;
  EXPECT_THAT([&] { planPoses(away, few()); }, ::testing::ThrowsMessage<InsufficientData>(HasSubstr("only 0 of")));
}

TEST_F(PlanOfCobot, NothingOpenCannotBeSeparated) {
  PlanOptions options = few();
  options.aim = PlanAim::kSeparate;
  EXPECT_THAT([&] { planPoses(known_->cell, options); }, ::testing::ThrowsMessage<InsufficientData>(HasSubstr("nothing to tell apart")));
}

TEST_F(PlanOfCobot, RivalsAreToldApartWithinFewPoses) {
  PlanningCell cell = test::withEffect(*known_, {"joint_gain", "joint:4", {{"gain", 1.5e-3}}});
  cell.open = {
      {.explanations = {
           {"joint_gain", "joint:4", "q4", 0.5}, {"joint_eccentricity", "joint:4", "q4", 0.4}, {"joint_scatter", "joint:4", "none", 0.1}}}};
  PlanOptions options = few();
  options.aim = PlanAim::kSeparate;
  options.count = 20;
  const Plan plan = planPoses(cell, options);
  ASSERT_THAT(plan.odds, SizeIs(2));
  EXPECT_EQ(plan.odds.front().right, "joint_gain@joint:4/q4");
  EXPECT_NEAR(plan.odds.front().before, 1.25, 1e-9);
  EXPECT_NEAR(plan.odds.back().before, 0.8, 1e-9);
  // Enough: the wrong ones together are at most one in twenty.
  double wrong = 0.0;
  for (const RivalOdds& odds : plan.odds) wrong += 1.0 / odds.expected;
  EXPECT_LE(wrong, 1.0 / 20.0);
  EXPECT_LT(plan.poses.size(), 20u);
  ASSERT_THAT(plan.not_told, SizeIs(1));
  EXPECT_THAT(plan.not_told.front(), HasSubstr("take some poses again"));
}

TEST(PlanCsv, IsAsSamplesHaveIt) {
  Plan plan;
  plan.poses.push_back({Eigen::Vector2d(0.5, -1.0), Eigen::Vector2d(1.0, -1.0)});
  plan.poses.push_back({Eigen::Vector2d(0.25, 2.0), Eigen::Vector2d(-1.0, 1.0)});
  EXPECT_EQ(planCsv(plan, 60), "image,q1,q2,dir1,dir2\nimages/0060.png,0.5,-1.0,1,-1\nimages/0061.png,0.25,2.0,-1,1\n");
}

}  // namespace
}  // namespace poecal
