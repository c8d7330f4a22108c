#include "planning/pool.hpp"

#include <gmock/gmock.h>

#include "cell/visible_poses.hpp"
#include "planning/planned_cell.hpp"

namespace poecal {
namespace {

TEST(PathOrder, GoesToTheNearest) {
  const std::vector<JointLimits> ranges{{0.0, 10.0}};
  std::vector<Eigen::VectorXd> poses;
  for (const double q : {9.0, 1.0, 5.0, 3.0}) poses.push_back(Eigen::VectorXd::Constant(1, q));
  EXPECT_THAT(pathOrder(poses, Eigen::VectorXd::Zero(1), ranges), ::testing::ElementsAre(1u, 3u, 2u, 0u));
}

TEST(PathOrder, ComesFromTheOtherSideWhereThatIsNearlyAsNear) {
  const std::vector<JointLimits> ranges{{0.0, 10.0}};
  std::vector<Eigen::VectorXd> poses;
  for (const double q : {5.0, 6.0, 3.9}) poses.push_back(Eigen::VectorXd::Constant(1, q));
  // Up to 5; then 3.9 is a little farther than 6, and downward.
  EXPECT_THAT(pathOrder(poses, Eigen::VectorXd::Constant(1, 4.9), ranges), ::testing::ElementsAre(0u, 2u, 1u));
}

class PoolOfCobot : public ::testing::Test {
 protected:
  PoolOfCobot() : known_(test::plannedCell("cobot6", 1, 15)), pool_(known_.cell, options_) {}
  test::PlannedCell known_;
  PlanOptions options_;
  Pool pool_;
};

TEST_F(PoolOfCobot, PosesAreInViewWithinLimitsAndApart) {
  long drawn = 0;
  const std::vector<Sample> samples = pool_.visible(PoolPurpose::kCandidates, 0, 50, &drawn);
  ASSERT_THAT(samples, ::testing::SizeIs(50));
  EXPECT_GT(drawn, 50);
  for (const Sample& sample : samples) {
    const Cell& cell = known_.cell.model.cell;
    EXPECT_TRUE(wellInView(*cell.camera, known_.cell.target, cell.registration.cameraTarget(forwardKinematics(*cell.arm, sample.q))));
    EXPECT_TRUE(pool_.clearance().isFree(sample.q));
    for (std::size_t k = 0; k < cell.arm->joints.size(); ++k) {
      if (!cell.arm->joints[k].limits) continue;
      EXPECT_GE(sample.q(static_cast<Eigen::Index>(k)), cell.arm->joints[k].limits->lower);
      EXPECT_LE(sample.q(static_cast<Eigen::Index>(k)), cell.arm->joints[k].limits->upper);
    }
  }
}

TEST_F(PoolOfCobot, SequencesDiffer) {
  EXPECT_NE(pool_.visible(PoolPurpose::kRandom, 0, 1).front().q, pool_.visible(PoolPurpose::kRandom, 1, 1).front().q);
  EXPECT_EQ(pool_.visible(PoolPurpose::kRandom, 1, 1).front().q, pool_.visible(PoolPurpose::kRandom, 1, 1).front().q);
}

// A camera that may be elsewhere leaves the poses that are in the middle of the picture.
TEST_F(PoolOfCobot, RoughPlacesLeaveFewerPoses) {
  PlanningCell rough = known_.cell;
  rough.rough_position = 0.05;
  rough.rough_rotation = 0.05;
  long sure = 0, unsure = 0;
  pool_.visible(PoolPurpose::kCandidates, 0, 20, &sure);
  Pool(rough, options_).visible(PoolPurpose::kCandidates, 0, 20, &unsure);
  EXPECT_GT(unsure, sure);
}

}  // namespace
}  // namespace poecal
