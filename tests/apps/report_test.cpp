// poecal report, and the page that the other commands leave.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "poecal/report/report.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ReportCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!reportBuilt()) GTEST_SKIP() << "built without D3";
    test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures);
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  test::ProgramRun run(const std::string& arguments) const { return test::runProgram(folder_.path(), arguments); }

  const test::TempFolder folder_;
};

TEST_F(ReportCommand, WritesThePageOfTheRunAgain) {
  const test::ProgramRun first = run("run capture --out out");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("results in out, to look at: out/report.html\n"));
  const std::string page = readTextFile(path("out/report.html"));
  EXPECT_THAT(page, HasSubstr("data:image/jpeg;base64,"));
  fs::remove(path("out/report.html"));
  const test::ProgramRun again = run("report out");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.out, "out/report.html\n");
  EXPECT_TRUE(readTextFile(path("out/report.html")) == page);
  EXPECT_EQ(nlohmann::json::parse(run("report out --json").out)["file"], "out/report.html");
}

TEST_F(ReportCommand, WithoutThePicturesThePageIsThereAllTheSame) {
  ASSERT_EQ(run("run capture --out out").status, 0);
  fs::remove_all(path("capture"));
  EXPECT_EQ(run("report out").status, 0);
  EXPECT_THAT(readTextFile(path("out/report.html")), ::testing::Not(HasSubstr("data:image/jpeg")));
}

TEST_F(ReportCommand, IsOfWhatIdentifyAndDiagnoseLeft) {
  for (const char* command : {"identify", "diagnose"}) {
    const test::ProgramRun made = run(std::string(command) + " capture --out " + command);
    ASSERT_EQ(made.status, 0) << made.err;
    const test::ProgramRun result = run(std::string("report ") + command);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(fs::exists(path(std::string(command) + "/report.html")));
  }
}

TEST_F(ReportCommand, OfAFolderWithoutResultsSaysWhichCommandMakesThem) {
  const test::ProgramRun result = run("report capture");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(result.err, "poecal: error: capture/report.json: there is none, expected the results of poecal run, identify or diagnose\n");
}

TEST_F(ReportCommand, APageOfAFleetLeadsToTheReports) {
  ASSERT_EQ(run("run capture --out results/cell-1").status, 0);
  ASSERT_EQ(run("identify capture --out 'results/cell #2'").status, 0);
  const test::ProgramRun result = run("fleet results/* --out results/fleet.csv --page results/fleet.html");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("2 captures in results/fleet.csv, to look at: results/fleet.html\n"));
  const std::string page = readTextFile(path("results/fleet.html"));
  EXPECT_THAT(page, HasSubstr("\"report\":\"cell-1/report.html\""));
  EXPECT_THAT(page, HasSubstr("\"name\":\"cell #2\",\"report\":null"));
  EXPECT_EQ(run("fleet results/cell-1 --out fleet.csv --page results/cell-1/report.html").status, 2);
}

TEST_F(ReportCommand, NoInputIsReplacedByAReport) {
  fs::rename(path("capture/target.yaml"), path("capture/report.json"));
  test::replaceInFile(path("capture/capture.yaml"), "target.yaml", "report.json");
  const test::ProgramRun result = run("run capture --out capture");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("report.json is an input itself"));
}

}  // namespace
}  // namespace poecal
