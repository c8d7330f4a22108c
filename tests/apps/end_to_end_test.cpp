// From a scene to a calibrated URDF, with the commands that a user types: the README's quick start on a smaller cell.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class EndToEnd : public ::testing::Test {
 protected:
  test::ProgramRun run(const std::string& arguments) { return test::runProgram(folder_.path(), arguments); }
  /// Runs and expects success without a word on stderr.
  test::ProgramRun runWell(const std::string& arguments) {
    test::ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, IsEmpty()) << arguments;
    return result;
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  test::TempFolder folder_;
};

TEST_F(EndToEnd, FromPicturesOfBoardAndTagToACalibratedUrdf) {
  test::writeSmallScene(folder_.path(), test::SmallCell::kPictures, "intrinsics: {target: board.yaml, count: 8}\n");
  runWell("simulate scene/scene.yaml --out capture");
  const auto capture = test::contentOf(path("capture"));
  const test::ProgramRun result = run("run capture --out out");
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* rung : {"nominal", "registered", "identified"}) EXPECT_THAT(result.out, HasSubstr(std::string("\n  ") + rung));
  for (const char* file : {"camera.yaml", "camera-residuals.csv", "detections.csv", "registration.yaml", "flange_poses.csv", "model.yaml",
                           "identification.json"}) {
    EXPECT_TRUE(fs::exists(path("out") / file)) << file;
  }
  EXPECT_EQ(test::contentOf(path("capture")), capture) << "an input is never changed";

  const nlohmann::json report = nlohmann::json::parse(readTextFile(path("out/identification.json")));
  EXPECT_TRUE(report.is_object());

  runWell("predict capture --model out/model.yaml --out predicted.csv");
  EXPECT_EQ(CsvTable::read(path("predicted.csv")).rowCount(), 4u * test::kSmallCellPoses);

  runWell("export out/model.yaml --urdf capture/cobot6.urdf --out calibrated.urdf");
  const Arm calibrated = readUrdf(path("calibrated.urdf"), "base_link", "flange");
  const Arm identified = *readModel(path("out/model.yaml")).cell.arm;
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(6, 0.3);
  constexpr double kSameArm = 1e-12;  // two texts of 17 digits
  EXPECT_TRUE(forwardKinematics(calibrated, q).isApprox(forwardKinematics(identified, q), kSameArm));
}

// The scenes of calib_data with an effect: the diagnosis names what the scene says, and nothing else.
class SceneWithAnEffect : public EndToEnd, public ::testing::WithParamInterface<const char*> {};

TEST_P(SceneWithAnEffect, IsDiagnosed) {
  const fs::path scene = fs::path(POECAL_SOURCE_DIR) / "calib_data/cobot6" / (std::string("scene-") + GetParam() + ".yaml");
  runWell("simulate " + scene.string() + " --out capture");
  runWell("diagnose capture --out out");
  const auto diagnosis = nlohmann::json::parse(readTextFile(path("out/diagnosis.json")));
  ASSERT_EQ(diagnosis["findings"].size(), 1u);
  const std::string truth = readTextFile(path("capture-truth/truth.yaml"));
  for (const char* word : {"effect", "location", "driver"}) {
    EXPECT_THAT(truth, HasSubstr(std::string(word) + ": " + diagnosis["findings"][0][word].get<std::string>()));
  }
}

INSTANTIATE_TEST_SUITE_P(All, SceneWithAnEffect, ::testing::Values("lens", "mount"),
                         [](const auto& instance) { return std::string(instance.param); });

/// Rows that a text takes on a terminal of 100 columns.
std::size_t rowsOnTerminal(const std::string& text) {
  constexpr std::size_t kColumns = 100;
  std::size_t rows = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    rows += std::max<std::size_t>(1, (end - begin + kColumns - 1) / kColumns);
    begin = end + 1;
  }
  return rows;
}

TEST_F(EndToEnd, TwoFindingsFitOneScreen) {
  fs::copy(fs::path(POECAL_SOURCE_DIR) / "calib_data/cobot6", path("scene"));
  const std::string scene = readTextFile(path("scene/scene-corners.yaml"));
  folder_.write("scene/scene.yaml", scene +
                                        "effects:\n"
                                        "  - {effect: joint_coupling, location: joint:6, parameters: {source: 5, ratio: 1.0e-3}}\n"
                                        "  - {effect: joint_backlash, location: joint:2, parameters: {half_gap: 3.0e-4}}\n");
  runWell("simulate scene/scene.yaml --out capture");
  const test::ProgramRun result = runWell("run capture --out out");
  const auto diagnosis = nlohmann::json::parse(readTextFile(path("out/diagnosis.json")));
  ASSERT_EQ(diagnosis["findings"].size(), 2u);
  constexpr std::size_t kScreen = 40, kCommandAndPrompt = 2;
  EXPECT_LE(rowsOnTerminal(result.out), kScreen - kCommandAndPrompt) << result.out;
  EXPECT_THAT(result.out, HasSubstr("\n  not tested everywhere: rolling_shutter, "));
  EXPECT_THAT(runWell("diagnose capture --out out").out,
              HasSubstr("\n  not tested: rolling_shutter at camera.shutter (no dq1.. columns)\n"));
}

TEST_F(EndToEnd, StepsBeforeTheCalibrationGiveJsonToo) {
  test::writeSmallScene(folder_.path(), test::SmallCell::kPictures, "intrinsics: {target: board.yaml, count: 4}\n", 3);
  const std::string paper = "paper '" + std::string(POECAL_SOURCE_DIR) + "/calib_data/puma560' --seeds 1";
  for (const std::string& step :
       {std::string("simulate scene/scene.yaml --out capture"), std::string("detect capture --out detections.csv"),
        std::string("intrinsics capture/intrinsics --out camera.yaml"), paper}) {
    const test::ProgramRun result = run(step + " --json");
    ASSERT_EQ(result.status, 0) << step << "\n" << result.err;
    EXPECT_TRUE(nlohmann::json::parse(result.out).is_object()) << step;
  }
}

TEST_F(EndToEnd, WhatIsUpToDateIsNotDoneAgain) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures);
  runWell("run capture --out out");
  const auto first = test::contentOf(path("out"));
  const auto detected = fs::last_write_time(path("out/detections.csv"));
  runWell("run capture --out out");
  EXPECT_EQ(fs::last_write_time(path("out/detections.csv")), detected);
  EXPECT_EQ(test::contentOf(path("out")), first);
  // A sample less is another input.
  test::rewriteCsv(path("capture/samples.csv"), [](test::Rows& rows) { rows.pop_back(); });
  runWell("run capture --out out");
  EXPECT_NE(fs::last_write_time(path("out/detections.csv")), detected);
}

TEST_F(EndToEnd, ResultsDoNotDependOnTheNumberOfJobs) {
  test::writeSmallScene(folder_.path(), test::SmallCell::kPictures);
  for (const std::string jobs : {"1", "2"}) {
    // Each in a folder of its own: report.json names that of the capture.
    runWell("simulate scene/scene.yaml --out " + jobs + "/capture --jobs " + jobs);
    runWell("run " + jobs + "/capture --out " + jobs + "/out --jobs " + jobs);
  }
  for (const char* folder : {"capture", "capture-truth", "out"}) {
    EXPECT_TRUE(test::contentOf(path("1") / folder) == test::contentOf(path("2") / folder)) << folder;
  }
}

TEST_F(EndToEnd, QuietIsSilentAndJsonIsJson) {
  test::writeSmallScene(folder_.path(), test::SmallCell::kCorners);
  const std::string steps[] = {"simulate scene/scene.yaml --out capture",
                               "run capture --out out",
                               "measure capture --out measured",
                               "identify capture --out identified",
                               "identify --robot scene/robot.yaml --poses measured/flange_poses.csv --registered --out from_poses",
                               "predict capture --model out/model.yaml --out predicted.csv",
                               "export out/model.yaml --urdf capture/cobot6.urdf --out calibrated.urdf"};
  writeTextFile(path("scene/robot.yaml"), robotYaml(readUrdf(path("scene/cobot6.urdf"), "base_link", "flange")));
  for (const std::string& step : steps) {
    const test::ProgramRun loud = run(step + " --json");
    ASSERT_EQ(loud.status, 0) << step << "\n" << loud.err;
    EXPECT_TRUE(nlohmann::json::parse(loud.out).is_object()) << step;
    if (step.starts_with("simulate")) {
      for (const char* made : {"capture", "capture-truth"}) fs::remove_all(path(made));
    }
    const test::ProgramRun quiet = runWell(step + " --quiet");
    EXPECT_THAT(quiet.out, IsEmpty()) << step;
  }
}

}  // namespace
}  // namespace poecal
