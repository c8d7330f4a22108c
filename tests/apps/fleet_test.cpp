// poecal fleet: the figures of many captures as the stages wrote them, and nothing where they wrote nothing.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "poecal/core/csv.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Fleet : public ::testing::Test {
 protected:
  test::ProgramRun run(const std::string& arguments) const { return test::runProgram(folder_.path(), arguments); }
  void runWell(const std::string& arguments) const {
    const test::ProgramRun result = run(arguments);
    ASSERT_EQ(result.status, 0) << arguments << "\n" << result.err;
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  json readJson(const std::string& name) const { return json::parse(readTextFile(path(name))); }
  /// A capture of corners in FOLDER/capture.
  void simulate(const std::string& more, int poses) const {
    test::writeSmallScene(folder_.path(), test::SmallCell::kCorners, more, poses);
    fs::remove_all(path("capture"));
    fs::remove_all(path("capture-truth"));
    runWell("simulate scene/scene.yaml --out capture");
  }

  test::TempFolder folder_;
};

TEST_F(Fleet, TellsWhatTheStagesWrote) {
  simulate("effects: [{effect: joint_coupling, location: joint:6, parameters: {ratio: 4.0e-3, source: 5}}]\n", 40);
  runWell("run capture --out results/flawed");
  simulate("", test::kSmallCellPoses);
  runWell("run capture --out results/few");
  runWell("measure capture --out results/measured");
  fs::create_directories(path("results/empty"));
  const test::ProgramRun told = run("fleet results/flawed results/few results/measured results/empty --out fleet.csv");
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("joint_coupling at joint:6 (ratio 0.00"));
  EXPECT_THAT(told.out, HasSubstr("4 captures in fleet.csv"));

  const CsvTable table = CsvTable::read(path("fleet.csv"));
  ASSERT_EQ(table.rowCount(), 4u);
  const auto cell = [&table](std::size_t row, const char* column) { return table.text(row, table.column(column)); };
  const auto number = [&table](std::size_t row, const char* column) { return table.number(row, table.column(column)); };
  const json identification = readJson("results/flawed/identification.json"), diagnosis = readJson("results/flawed/diagnosis.json");
  EXPECT_EQ(cell(0, "name"), "flawed");
  EXPECT_EQ(cell(0, "folder"), "results/flawed");
  EXPECT_EQ(cell(0, "pictures"), "40");
  EXPECT_EQ(cell(0, "pictures_with_corners"), "40");
  EXPECT_EQ(number(0, "nominal_px"), identification["stages"][0]["held_out"]["rms_px"].get<double>());
  EXPECT_EQ(number(0, "registered_px"), identification["stages"][1]["held_out"]["rms_px"].get<double>());
  EXPECT_EQ(number(0, "identified_px"), identification["stages"][2]["held_out"]["rms_px"].get<double>());
  EXPECT_EQ(number(0, "identified_mm"), identification["stages"][2]["held_out"]["position_mm"]["mean"].get<double>());
  EXPECT_EQ(cell(0, "verdict"), "effects");
  EXPECT_THAT(cell(0, "findings"), HasSubstr("joint_coupling"));
  EXPECT_THAT(cell(0, "locations"), HasSubstr("joint:6"));
  EXPECT_EQ(number(0, "diagnosed_px"), diagnosis["gap"]["stages"].back()["rms_px"].get<double>());
  EXPECT_EQ(number(0, "shrinkage"), diagnosis["gap"]["shrinkage"].get<double>());
  EXPECT_EQ(number(0, "shrinkage_low"), diagnosis["gap"]["shrinkage_ci95"][0].get<double>());

  EXPECT_EQ(cell(1, "verdict"), "insufficient data");
  EXPECT_THAT(cell(1, "warnings"), HasSubstr("10 poses are too few"));
  EXPECT_EQ(cell(1, "findings"), "");

  EXPECT_EQ(cell(2, "pictures"), "10");
  EXPECT_GT(number(2, "registration_px"), 0.0);
  for (const char* column : {"poses", "nominal_px", "identified_mm", "verdict", "diagnosed_px", "shrinkage"}) {
    EXPECT_EQ(cell(2, column), "") << column;
  }
  for (std::size_t column = 2; column < table.header().size(); ++column) EXPECT_EQ(table.text(3, column), "") << table.header()[column];
}

TEST_F(Fleet, GivesJson) {
  simulate("", test::kSmallCellPoses);
  runWell("measure capture --out results/measured");
  const test::ProgramRun result = run("fleet results/measured --out fleet.csv --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const json summary = json::parse(result.out);
  ASSERT_EQ(summary["captures"].size(), 1u);
  EXPECT_EQ(summary["captures"][0]["pictures"], 10);
  EXPECT_TRUE(summary["captures"][0]["identified_px"].is_null());
  EXPECT_THAT(summary["captures"][0]["warnings"], ElementsAre());
}

TEST_F(Fleet, WhatCannotBeReadIsNamed) {
  fs::create_directories(path("nothing"));
  const test::ProgramRun nothing = run("fleet nothing --out fleet.csv");
  EXPECT_EQ(nothing.status, 3);
  EXPECT_THAT(nothing.err, HasSubstr("nothing: holds no results, expected a folder that run, or one of its steps, wrote"));
  EXPECT_FALSE(fs::exists(path("fleet.csv")));
  fs::create_directories(path("good"));
  const auto error = [this](const std::string& folder) {
    const test::ProgramRun result = run("fleet good " + folder + " --out fleet.csv");
    EXPECT_EQ(result.status, 3) << folder;
    return result.err;
  };
  EXPECT_THAT(error("none"), HasSubstr("poecal: error: none: no such folder"));
  folder_.write("capture/capture.yaml", "a capture is no folder of results\n");
  EXPECT_THAT(error("capture"), HasSubstr("poecal: error: capture: holds no results"));
  folder_.write("cut/diagnosis.json", "{\n  \"format\": \"poecal-diagnosis/1\",\n  \"verdict\": \"no");
  EXPECT_THAT(error("cut"), HasSubstr("cut/diagnosis.json:3: not valid YAML"));
  folder_.write("other/identification.json", "{\n  \"format\": \"poecal-diagnosis/1\"\n}\n");
  EXPECT_THAT(error("other"), HasSubstr("other/identification.json:2: format: is 'poecal-diagnosis/1', expected poecal-identification/1"));
  folder_.write("less/registration.yaml", "format: poecal-registration/1\nrms_px: 1.0\n");
  EXPECT_THAT(error("less"), HasSubstr("less/registration.yaml:1: key 'free_rms_px' is missing"));
  EXPECT_FALSE(fs::exists(path("fleet.csv")));
  EXPECT_EQ(run("fleet --out fleet.csv").status, 2);
  const test::ProgramRun twice = run("fleet good other/../good --out fleet.csv");
  EXPECT_THAT(twice.err, HasSubstr("other/../good is named twice, expected each folder once"));
}

}  // namespace
}  // namespace poecal
