// poecal plan: from a capture, before the first picture, and what the capture that follows makes of it.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr const char* kFirst =
    "--robot scene/cobot6.urdf --base-link base_link --tip-link flange --camera scene/camera.yaml --target scene/target.yaml ";

class PlanCommand : public ::testing::Test {
 protected:
  test::ProgramRun run(const std::string& arguments) const { return test::runProgram(folder_.path(), arguments); }
  json runJson(const std::string& arguments) const {
    const test::ProgramRun result = run(arguments + " --json");
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result.status == 0 ? json::parse(result.out) : json();
  }
  void runWell(const std::string& arguments) const {
    const test::ProgramRun result = run(arguments);
    ASSERT_EQ(result.status, 0) << arguments << "\n" << result.err;
  }
  void expectError(const std::string& arguments, int status, const std::string& message) const {
    const test::ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, status) << arguments;
    EXPECT_THAT(result.err, HasSubstr(message)) << arguments;
    EXPECT_FALSE(fs::exists(path("next.csv"))) << arguments;
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  test::TempFolder folder_;
};

TEST_F(PlanCommand, TheCaptureThatFollowsIsAsCertainAsThePlanSaid) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners, 14);
  runWell("run capture --out out --quiet");
  const json plan = runJson("plan capture --model out/model.yaml --count 8 --candidates 300 --out next.csv");
  EXPECT_LT(plan["after"]["position_mm"], plan["before"]["position_mm"]);
  EXPECT_GE(plan["random_poses"], 16);

  const Arm arm = readUrdf(path("scene/cobot6.urdf"), "base_link", "flange");
  const SampleTable next = readSamples(path("next.csv"), arm.jointCount(), &arm);
  ASSERT_THAT(next.samples, SizeIs(8));
  EXPECT_EQ(next.samples.front().image, "images/0014.png");

  // Both captures in one: the rows of next.csv behind those that there are.
  fs::create_directories(path("old"));
  fs::copy(path("capture/samples.csv"), path("old/samples.csv"));
  SampleTable all = readSamples(path("old/samples.csv"), arm.jointCount(), &arm);
  for (Sample& sample : all.samples) {
    sample.pose.reset();
    sample.stamp.reset();
  }
  all.samples.insert(all.samples.end(), next.samples.begin(), next.samples.end());
  folder_.write("scene/all.csv", samplesCsv(all));
  test::writeSmallScene(folder_.path(), test::SmallCell::kCorners, "samples: {file: all.csv, seed: 12}\n");
  runWell("simulate scene/scene.yaml --out more --quiet");
  runWell("run more --out out-more --quiet");
  const json further = runJson("plan more --model out-more/model.yaml --count 8 --candidates 300 --out further.csv");
  // Said from 14 pictures and found from 22, where noise and tolerance are estimated anew: 14 poses tell the noise to a tenth, the
  // tolerance less.
  EXPECT_NEAR(further["before"]["position_mm"].get<double>() / plan["after"]["position_mm"].get<double>(), 1.0, 0.3);
}

TEST_F(PlanCommand, PlansAWholeFirstCapture) {
  test::writeSmallScene(folder_.path(), test::SmallCell::kCorners);
  const json plan = runJson(std::string("plan ") + kFirst +
                            "--camera-at -0.3 1.5 0.6 --look-at 0 0.3 0.5 --rough-position 0.02 --rough-rotation 0.03 "
                            "--count 12 --candidates 100 --out first.csv");
  EXPECT_EQ(plan["poses"], 12);
  const Arm arm = readUrdf(path("scene/cobot6.urdf"), "base_link", "flange");
  const SampleTable first = readSamples(path("first.csv"), arm.jointCount(), &arm);
  EXPECT_EQ(first.samples.front().image, "images/0000.png");
  // All of it shows where the camera is not quite where it was said to be: 2 cm off.
  folder_.write("scene/scene.yaml", readTextFile(path("scene/scene.yaml")));
}

TEST_F(PlanCommand, TellsHowWellAnEffectWouldShow) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners, 14);
  runWell("run capture --out out --quiet");
  const test::ProgramRun told =
      run("plan capture --model out/model.yaml --count 5 --candidates 200 --detect joint_backlash@joint:2 0.001 --out next.csv");
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("joint_backlash@joint:2 of size 0.001: expected S now "));
  EXPECT_THAT(told.out, HasSubstr("dir1.. is part of the plan"));
  EXPECT_THAT(told.out, HasSubstr("not checked: bent links"));
}

TEST_F(PlanCommand, SameInputSameBytes) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners, 14);
  runWell("run capture --out out --quiet");
  runWell("plan capture --model out/model.yaml --count 5 --candidates 200 --out one.csv --jobs 1");
  runWell("plan capture --model out/model.yaml --count 5 --candidates 200 --out two.csv --jobs 3");
  EXPECT_EQ(readTextFile(path("one.csv")), readTextFile(path("two.csv")));
}

TEST_F(PlanCommand, WhatIsMissingIsNamed) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners, 14);
  runWell("run capture --out out --quiet");
  expectError("plan capture --out next.csv", 2, "needs --model");
  expectError("plan --out next.csv", 2, "plan needs a CAPTURE and --model, or --robot");
  expectError("plan --robot scene/cobot6.urdf --out next.csv", 2, "--robot needs --camera and --target");
  expectError(std::string("plan ") + kFirst + "--out next.csv", 2, "needs --camera-at and --look-at, or --registration");
  expectError("plan capture --model out/model.yaml --separate --out next.csv", 4, "nothing to tell apart");
  expectError("plan capture --model out/model.yaml --detect joint_gain@joint:3 much --out next.csv", 2, "'much' is no size");
  expectError("plan capture --model out/nothing.yaml --out next.csv", 3, "out/nothing.yaml");
  expectError(std::string("plan ") + kFirst + "--camera-at 0 0 9 --look-at 0 0 10 --out next.csv", 4,
              "expected camera and target where more postures");
  test::replaceInFile(path("capture/capture.yaml"), "detections: detections.csv\n", "");
  expectError("plan capture --model out/model.yaml --out next.csv", 3, "out/detections.csv: is not there, expected the corners");
  EXPECT_EQ(run("plan capture --model out/model.yaml --out out/model.yaml").status, 2);
}

}  // namespace
}  // namespace poecal
