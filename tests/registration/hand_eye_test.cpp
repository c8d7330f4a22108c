#include "poecal/registration/hand_eye.hpp"

#include <gmock/gmock.h>

#include "poecal/geometry/se3.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

std::vector<Eigen::Isometry3d> targetsOf(const HandEye& truth, const std::vector<Eigen::Isometry3d>& T_near_far) {
  std::vector<Eigen::Isometry3d> targets;
  for (const Eigen::Isometry3d& T : T_near_far) targets.push_back(truth.T_camera_near * T * truth.T_far_target);
  return targets;
}

TEST(HandEye, RecoversBothTransformsExactly) {
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 10; ++trial) {
    const HandEye truth{test::randomPose(rng), test::randomPose(rng)};
    std::vector<Eigen::Isometry3d> poses;
    for (int k = 0; k < 3 + trial; ++k) poses.push_back(test::randomPose(rng, 0.8));
    const auto found = solveHandEye(poses, targetsOf(truth, poses), Setup::kEyeToHand);
    ASSERT_TRUE(found);
    EXPECT_THAT(found->T_camera_near, test::PoseIsNear(truth.T_camera_near, 1e-11));
    EXPECT_THAT(found->T_far_target, test::PoseIsNear(truth.T_far_target, 1e-11));
  }
}

TEST(HandEye, OfAScaraExplainsAllPosesThoughSlidingIsFree) {
  Rng rng = test::rngOfThisTest();
  const HandEye truth{test::randomPose(rng), test::randomPose(rng)};
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 12; ++k) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = expSo3({0.0, 0.0, rng.uniform(-2.0, 2.0)});
    T.translation() = test::uniformVector(rng, 3, 0.4);
    poses.push_back(T);
  }
  EXPECT_EQ(rotationDirections(poses), 1);
  const auto targets = targetsOf(truth, poses);
  const auto found = solveHandEye(poses, targets, Setup::kEyeToHand);
  ASSERT_TRUE(found);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_THAT(Eigen::Isometry3d(found->T_camera_near * poses[k] * found->T_far_target), test::PoseIsNear(targets[k], 1e-9));
  }
}

TEST(HandEye, ASlowTurnIsSeenOverTheWholeSeries) {
  // Half a radian in five thousand steps: neighbours turn by 1e-4, less than anything that is taken for a turn.
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 5000; ++k) poses.emplace_back(Eigen::AngleAxisd(1e-4 * k, Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(rotationDirections(poses), 1);
}

TEST(HandEye, WithoutTurningThereIsNothing) {
  const std::vector<Eigen::Isometry3d> poses(5, Eigen::Isometry3d::Identity());
  EXPECT_FALSE(solveHandEye(poses, poses, Setup::kEyeToHand));
  EXPECT_EQ(rotationDirections(poses), 0);
}

}  // namespace
}  // namespace poecal
