#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "poecal/core/text.hpp"
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
using ::testing::IsEmpty;

Model fromUrdf(const std::string& base_link, const std::string& tip_link) {
  Model model;
  model.urdf = "arm.urdf";
  model.base_link = base_link;
  model.tip_link = tip_link;
  return model;
}

constexpr double kSamePose = 1e-13;  // two texts of 17 digits and a chain of ten poses

// A folder with arm.urdf and the model.yaml of an arm that is a little off.
class Export : public ::testing::Test {
 protected:
  Export() { place(test::kSevenJoints); }

  /// @param more  of the model beside its arm.
  void place(const test::UrdfExample& example, Model more = {}) {
    folder_.write("arm.urdf", example.text());
    Rng rng = test::rngOfThisTest();
    const Arm nominal = readUrdf(example.file(), example.base_link, example.tip_link);
    arm_ = displaceTwists(nominal, test::uniformVector(rng, twistParameterCount(nominal), 2e-3));
    more.cell.arm = arm_;
    folder_.write("model.yaml", modelYaml(more));
  }
  test::ProgramRun run(const std::string& options = "") {
    return test::runProgram(folder_.path(), "export model.yaml --urdf arm.urdf --out out/calibrated.urdf " + options);
  }
  void expectExported(const char* base_link, const char* tip_link) {
    const Arm exported = readUrdf(folder_.path() / "out/calibrated.urdf", base_link, tip_link);
    for (std::size_t k = 0; k < arm_.joints.size(); ++k) EXPECT_THAT(exported.joints[k].xi, test::IsNear(arm_.joints[k].xi, kSamePose));
    EXPECT_THAT(exported.gamma, test::IsNear(arm_.gamma, kSamePose));
  }

  test::TempFolder folder_;
  Arm arm_;
};

TEST_F(Export, OnlyChainOfTheUrdfNeedsNoNames) {
  const test::ProgramRun result = run();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("7 joints from link_0 to link_7"));
  EXPECT_THAT(result.err, IsEmpty());
  expectExported("link_0", "link_7");
  EXPECT_EQ(readTextFile(folder_.path() / "arm.urdf"), test::kSevenJoints.text()) << "the input stays";
}

TEST_F(Export, JsonSaysHowFarEachAxisMoved) {
  const test::ProgramRun result = run("--json");
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json summary = nlohmann::json::parse(result.out);
  const Arm nominal = readUrdf(test::kSevenJoints.file(), "link_0", "link_7");
  ASSERT_EQ(summary["joints"].size(), 7u);
  EXPECT_EQ(summary["joints"][3]["name"], "joint_4");
  EXPECT_NEAR(summary["joints"][3]["tilt"].get<double>(), axisOffset(nominal.joints[3], arm_.joints[3]).tilt, kSamePose);
  EXPECT_NEAR(summary["joints"][3]["shift"].get<double>(), axisOffset(nominal.joints[3], arm_.joints[3]).shift, kSamePose);
}

TEST_F(Export, ModelNamesTheLinks) {
  place(test::kSixJoints, fromUrdf("base_link", "tool0"));
  EXPECT_EQ(run().status, 0);
  expectExported("base_link", "tool0");
}

// The model's flange would be put where another link is.
TEST_F(Export, AnotherLinkThanTheModelsIsRefused) {
  place(test::kSixJoints, fromUrdf("base_link", "tool0"));
  const test::ProgramRun result = run("--tip-link finger");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("--tip-link is 'finger', expected 'tool0' as in the model"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out/calibrated.urdf"));
}

TEST_F(Export, LinksThatWereNamedAnewAreNamedByOptions) {
  place(test::kSixJoints, fromUrdf("robot_base", "robot_tool"));
  EXPECT_EQ(run("--base-link base_link --tip-link tool0").status, 0);
  expectExported("base_link", "tool0");
}

TEST_F(Export, SaysWhichOptionIsNeeded) {
  place(test::kSixJoints);
  const test::ProgramRun result = run();
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("poecal: error: arm.urdf has 2 chains, expected --tip-link"));
  EXPECT_THAT(result.err, HasSubstr("finger, other_finger"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out/calibrated.urdf"));
}

TEST_F(Export, WarnsOfEffectsThatAUrdfCannotHold) {
  Model model;
  Cell cell;
  cell.arm = arm_;
  model.effects = {makeEffect({.effect = "joint_backlash", .location = "joint:2", .parameters = {{"half_gap", 1e-4}}}, cell)};
  place(test::kSevenJoints, model);
  const test::ProgramRun result = run("--quiet");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(result.err, "poecal: warning: effect joint_backlash at joint:2 stays behind: a URDF holds geometry alone\n");
}

TEST_F(Export, RefusesToReplaceAnInput) {
  const test::ProgramRun result = test::runProgram(folder_.path(), "export model.yaml --urdf arm.urdf --out ./arm.urdf");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("./arm.urdf is an input itself"));
  EXPECT_EQ(readTextFile(folder_.path() / "arm.urdf"), test::kSevenJoints.text());
}

TEST_F(Export, BadInputIsStatusThreeWithItsPlace) {
  folder_.write("model.yaml", "format: poecal-model/1\nrobot:\n  joints: []\n");
  const test::ProgramRun result = run();
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("poecal: error: model.yaml:3: "));
}

TEST_F(Export, EveryFileComesFromOneCall) {
  Model more = fromUrdf("link_0", "link_7");
  more.cell.camera = Camera{};
  more.cell.camera->width = 640;
  more.cell.camera->height = 480;
  more.cell.camera->fx = more.cell.camera->fy = 500.0;
  more.cell.camera->distortion = Eigen::VectorXd::Zero(5);
  place(test::kSevenJoints, more);
  const test::ProgramRun result =
      run("--camera-info out/camera.yaml --transforms out/tf.yaml --dh out/dh.yaml --joint-table out/joints.csv --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  for (const char* key : {"urdf", "camera_info", "transforms", "dh", "joint_table"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / json[key].get<std::string>())) << key;
  }
  expectExported("link_0", "link_7");
}

TEST_F(Export, ARobotYamlServesWhereThereIsNoUrdf) {
  folder_.write("robot.yaml", robotYaml(arm_));
  const test::ProgramRun result = test::runProgram(folder_.path(), "export model.yaml --robot robot.yaml --dh dh.yaml");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(readTextFile(folder_.path() / "dh.yaml"), HasSubstr("format: poecal-dh/1"));
}

TEST_F(Export, WhatIsMissingIsSaidAndNothingIsWritten) {
  const auto expectWrong = [this](const std::string& options, const std::string& message) {
    const test::ProgramRun result = test::runProgram(folder_.path(), "export model.yaml " + options);
    EXPECT_EQ(result.status, 2) << options;
    EXPECT_THAT(result.err, HasSubstr(message)) << options;
  };
  expectWrong("", "export needs a file to write");
  expectWrong("--out x.urdf", "--out needs --urdf");
  expectWrong("--dh dh.yaml", "need the nominal arm");
  expectWrong("--urdf arm.urdf --dh dh.yaml --camera-info ci.yaml", "this model has no camera");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "dh.yaml"));
}

}  // namespace
}  // namespace poecal
