// poecal compensate: from files to files.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "poecal/capture/capture.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/robot/robot_file.hpp"
#include "robot/urdf_examples.hpp"
#include "support/matchers.hpp"
#include "support/program.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

/// A model whose arm is a little off and whose second joint has play; tables to compensate.
class CompensateFiles : public ::testing::Test {
 protected:
  CompensateFiles() {
    folder_.write("arm.urdf", test::kSixJoints.text());
    nominal_ = readUrdf(test::kSixJoints.file(), test::kSixJoints.base_link, test::kSixJoints.tip_link);
    Rng rng = test::rngOfThisTest();
    model_.urdf = "arm.urdf";
    model_.base_link = test::kSixJoints.base_link;
    model_.tip_link = test::kSixJoints.tip_link;
    model_.cell.arm = displaceTwists(nominal_, test::uniformVector(rng, twistParameterCount(nominal_), 2e-3));
    model_.effects = {makeEffect({.effect = "joint_backlash", .location = "joint:2", .parameters = {{"half_gap", 1e-3}}}, model_.cell)};
    folder_.write("model.yaml", modelYaml(model_));
  }
  /// A pose that the model's geometry reaches, as cells x to qw.
  std::string reachablePose() const {
    Eigen::VectorXd q(6);
    q << 0.1, -0.7, 0.9, 0.3, 0.8, -0.4;
    const Eigen::Isometry3d T = forwardKinematics(*model_.cell.arm, q);
    std::string cells;
    for (const double t : T.translation()) cells += formatNumber(t) + ",";
    const Eigen::Vector4d c = quaternionXyzw(T);
    return cells + formatNumber(c(0)) + "," + formatNumber(c(1)) + "," + formatNumber(c(2)) + "," + formatNumber(c(3)) + "\n";
  }
  test::ProgramRun run(const std::string& options) { return test::runProgram(folder_.path(), "compensate --out out.csv " + options); }
  CsvTable out() const { return CsvTable::read(folder_.path() / "out.csv"); }

  /// Joints within all limits, away from stretched elbows.
  const std::string joints_ =
      "q1,q2,q3,q4,q5,q6,dir1,dir2,dir3,dir4,dir5,dir6\n"
      "0.1,-0.7,0.9,0.3,0.8,-0.4,1,1,1,1,1,1\n"
      "0.1,-0.7,0.9,0.3,0.8,-0.4,1,-1,1,1,1,1\n";
  test::TempFolder folder_;
  Arm nominal_;
  Model model_;
};

TEST_F(CompensateFiles, TheModelReachesWithTheCommandsWhatTheNominalArmMeans) {
  folder_.write("q.csv", joints_);
  const test::ProgramRun result = run("--model model.yaml --joints q.csv --robot arm.urdf");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("joints for 2 of 2 rows, 1 effect of the arm compensated: out.csv"));
  const CsvTable table = out();
  ASSERT_EQ(table.rowCount(), 2u);
  const SampleTable asked = readJointTable(folder_.path() / "q.csv", nominal_);
  for (std::size_t row = 0; row < 2; ++row) {
    Eigen::VectorXd q(6);
    for (std::size_t k = 0; k < 6; ++k) q(static_cast<Eigen::Index>(k)) = table.number(row, table.column("q" + std::to_string(k + 1)));
    Eigen::VectorXd really = q;
    really(1) += asked.samples[row].dir(1) * 1e-3;  // what backlash is
    EXPECT_THAT(forwardKinematics(*model_.cell.arm, really), test::PoseIsNear(forwardKinematics(nominal_, asked.samples[row].q), 1e-9));
    EXPECT_LT(table.number(row, table.column("position_error")), 1e-9);
  }
  EXPECT_NEAR(table.number(1, table.column("q2")) - table.number(0, table.column("q2")), 2e-3, 1e-9);
}

TEST_F(CompensateFiles, PosesWithoutJointsAreReachedToo) {
  folder_.write("poses.csv", "x,y,z,qx,qy,qz,qw\n" + reachablePose());
  const test::ProgramRun result = run("--model model.yaml --poses poses.csv --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["reached"], 1);
  EXPECT_LT(json["compensated"]["position_max"], 1e-9);
}

TEST_F(CompensateFiles, RowsOutOfReachAreNamedAndNothingIsWrittenUnlessAsked) {
  folder_.write("poses.csv", "q1,q2,q3,q4,q5,q6,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,9,0,0,0,0,0,1\n");
  const test::ProgramRun refused = run("--model model.yaml --poses poses.csv");
  EXPECT_EQ(refused.status, 4);
  EXPECT_THAT(refused.err, HasSubstr("poecal: error: poses.csv:2: no joints were found that reach it"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out.csv"));
  folder_.write("poses.csv",
                "q1,q2,q3,q4,q5,q6,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,9,0,0,0,0,0,1\n0.1,-0.7,0.9,0.3,0.8,-0.4," + reachablePose());
  const test::ProgramRun left_out = run("--model model.yaml --poses poses.csv --leave-out");
  EXPECT_EQ(left_out.status, 0) << left_out.err;
  EXPECT_THAT(left_out.err, HasSubstr("poecal: warning: poses.csv:2: "));
  ASSERT_EQ(out().rowCount(), 1u);
  EXPECT_EQ(out().text(0, out().column("line")), "3");
}

TEST_F(CompensateFiles, WhatIsMissingIsSaid) {
  folder_.write("q.csv", joints_);
  EXPECT_EQ(run("--model model.yaml").status, 2);
  const test::ProgramRun no_robot = run("--model model.yaml --joints q.csv");
  EXPECT_EQ(no_robot.status, 2);
  EXPECT_THAT(no_robot.err, HasSubstr("--joints needs --robot"));
  EXPECT_EQ(run("--model model.yaml --poses q.csv --tip-link tool0").status, 2);
  const test::ProgramRun other_tip = run("--model model.yaml --joints q.csv --robot arm.urdf --tip-link elsewhere");
  EXPECT_EQ(other_tip.status, 2);
  EXPECT_THAT(other_tip.err, HasSubstr("--tip-link is 'elsewhere', expected '"));
  folder_.write("poses.csv", "x,y,z\n1,0,0\n");
  const test::ProgramRun no_rotation = run("--model model.yaml --poses poses.csv");
  EXPECT_EQ(no_rotation.status, 3);
  EXPECT_THAT(no_rotation.err, HasSubstr("poses.csv:1: "));
  EXPECT_THAT(no_rotation.err, HasSubstr("qx"));
  folder_.write("poses.csv", "x,y,z,qx,qy,qz,qw\n");
  EXPECT_EQ(run("--model model.yaml --poses poses.csv").status, 4);
}

TEST_F(CompensateFiles, AnEffectWithoutItsColumnIsTooLittleData) {
  model_.effects = {makeEffect(
      {.effect = "joint_drift", .location = "joint:1", .parameters = {{"rate", 1e-3}, {"reference", 20.0}}, .driver = "temperature"},
      model_.cell)};
  folder_.write("model.yaml", modelYaml(model_));
  folder_.write("q.csv", joints_);
  const test::ProgramRun result = run("--model model.yaml --joints q.csv --robot arm.urdf");
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("joint_drift at joint:1 cannot be computed: no temperature column"));
}

}  // namespace
}  // namespace poecal
