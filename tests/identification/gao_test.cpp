#include "identification/gao.hpp"

#include <gmock/gmock.h>

#include "poecal/core/statistics.hpp"
#include "poecal/identification/paper_experiment.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

const std::filesystem::path kPuma = std::filesystem::path(POECAL_SOURCE_DIR) / "calib_data" / "puma560";

GaoResult gaoOf(const Arm& nominal, const Arm& actual, int poses, const GaoOptions& options = {}) {
  Rng rng = test::rngOfThisTest();
  std::vector<Eigen::VectorXd> q;
  std::vector<Eigen::Isometry3d> T_base_flange;
  for (int k = 0; k < poses; ++k) {
    q.push_back(test::uniformVector(rng, nominal.jointCount(), M_PI));
    T_base_flange.push_back(forwardKinematics(actual, q.back()));
  }
  return gao(nominal, q, T_base_flange, options);
}

TEST(Gao, WithoutNoiseFallsQuadraticallyToRoundingInSixSteps) {
  const GaoResult result = gaoOf(readRobotYaml(kPuma / "robot.yaml"), readRobotYaml(kPuma / "actual.yaml"), 50, {.length_unit = 1e-3});
  ASSERT_GE(result.residuals.size(), 5u);
  EXPECT_GT(result.residuals.front(), 1.0);  // mm and rad
  EXPECT_LT(result.residuals[std::min<std::size_t>(6, result.residuals.size() - 1)], 1e-9);
  EXPECT_EQ(result.rank, 30);  // 4 r + 6
}

TEST(Gao, KeepsTheJointConstraintsWithoutNormalising) {
  const Arm nominal = readRobotYaml(kPuma / "robot.yaml");
  const GaoResult result = gaoOf(nominal, readRobotYaml(kPuma / "actual.yaml"), 50);
  for (const Joint& joint : result.arm.joints) {
    EXPECT_NEAR(joint.xi.head<3>().norm(), 1.0, 1e-12);
    EXPECT_NEAR(joint.xi.head<3>().dot(joint.xi.tail<3>()), 0.0, 1e-12);
  }
}

TEST(Gao, IdentifiesPrismaticJointsToo) {
  Rng rng = test::rngOfThisTest();
  Arm nominal;
  nominal.joints = {Joint::revolute("a", {0, 0, 1}, {0, 0, 0}), Joint::revolute("b", {0, 0, 1}, {0.3, 0, 0}),
                    Joint::prismatic("c", {0, 0, -1}), Joint::revolute("d", {0, 0, -1}, {0.55, 0, 0})};
  nominal.gamma << 0.1, -0.2, 0.3, 0.5, 0.0, 0.1;
  Arm actual = displaceTwists(nominal, test::uniformVector(rng, twistParameterCount(nominal), 2e-3));
  actual.gamma += test::uniformVector(rng, 6, 1e-3);
  const GaoResult result = gaoOf(nominal, actual, 30);
  EXPECT_LT(result.residuals.back(), 1e-12);
  EXPECT_NEAR(result.arm.joints[2].xi.tail<3>().norm(), 1.0, 1e-12);
  EXPECT_EQ(result.rank, 4 * 3 + 2 + 6);
  // The flange is right at poses that were not measured.
  const Eigen::VectorXd q = test::uniformVector(rng, 4, 3.0);
  EXPECT_THAT(forwardKinematics(result.arm, q), test::PoseIsNear(forwardKinematics(actual, q), 1e-11));
}

TEST(PaperExperimentStatistics, WeightedReachesTheStatisticalLimitAndGaoDoesNot) {
  const std::vector<PaperSeed> seeds = paperExperiment(readRobotYaml(kPuma / "robot.yaml"), readRobotYaml(kPuma / "actual.yaml"), {});
  std::vector<double> gao_position, weighted_position, weighted_rotation;
  for (const PaperSeed& seed : seeds) {
    gao_position.push_back(seed.gao.error.position);
    weighted_position.push_back(seed.weighted.error.position);
    weighted_rotation.push_back(seed.weighted.error.rotation);
  }
  EXPECT_EQ(seeds.size(), 20u);
  EXPECT_LE(median(weighted_position), 0.0180e-3);
  EXPECT_LE(median(weighted_rotation), 2.4e-4);
  // Rows unweighted at the base mix radians and millimetres through the lever: several times worse on the same poses.
  EXPECT_GT(median(gao_position), 3.0 * median(weighted_position));
}

}  // namespace
}  // namespace poecal
