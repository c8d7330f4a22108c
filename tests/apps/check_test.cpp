// poecal new and poecal check, as they are used at the cell.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Check : public ::testing::Test {
 protected:
  test::ProgramRun run(const std::string& arguments) { return test::runProgram(folder_.path(), arguments); }

  test::TempFolder folder_;
};

TEST_F(Check, FromANewFolderToACaptureThatIsCalibrated) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures);
  const test::ProgramRun made =
      run("new cell --robot capture/cobot6.urdf --tip-link flange --target capture/target.yaml --camera capture/camera.yaml");
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, StartsWith("cell/cobot6.urdf\ncell/target.yaml\ncell/camera.yaml\ncell/samples.csv\ncell/capture.yaml\n"));
  const test::ProgramRun empty = run("check cell");
  EXPECT_EQ(empty.status, 4);
  EXPECT_THAT(empty.out, HasSubstr("too little  samples     cell/samples.csv: no rows"));
  EXPECT_EQ(empty.err, "poecal: error: cell/samples.csv: no rows, expected one per pose\n");
  // What somebody does at the cell: pictures, and the columns of the new file.
  fs::remove(folder_.path() / "cell/images");
  fs::copy(folder_.path() / "capture/images", folder_.path() / "cell/images", fs::copy_options::recursive);
  std::string rows = readTextFile(folder_.path() / "cell/samples.csv");
  test::rewriteCsv(folder_.path() / "capture/samples.csv", [&rows](test::Rows& table) {
    for (std::size_t row = 1; row < table.size(); ++row) {
      for (std::size_t k = 0; k < 7; ++k) rows += table[row][k] + ",";
      rows += table[row][test::columnOf(table, "stamp")] + "\n";
    }
  });
  writeTextFile(folder_.path() / "cell/samples.csv", rows);
  const test::ProgramRun filled = run("check cell --detect 3");
  EXPECT_EQ(filled.status, 0) << filled.err;
  EXPECT_THAT(filled.out, HasSubstr("the target was found in 3 of 3 pictures tried\n"));
  EXPECT_THAT(filled.out, HasSubstr("cell can be calibrated\n"));
  EXPECT_EQ(run("run cell --out out").status, 0);
}

TEST_F(Check, JsonHasTheSame) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners);
  const test::ProgramRun result = run("check capture --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["status"], 0);
  EXPECT_GE(json["items"].size(), 8u);
  const test::ProgramRun nothing = run("check nowhere --json");
  EXPECT_EQ(nothing.status, 3);
  EXPECT_EQ(nlohmann::json::parse(nothing.out)["items"][0]["level"], "error");
}

TEST_F(Check, WritesNothing) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures);
  const auto before = test::contentOf(folder_.path() / "capture");
  EXPECT_EQ(run("check capture --detect 2").status, 0);
  EXPECT_EQ(test::contentOf(folder_.path() / "capture"), before);
}

}  // namespace
}  // namespace poecal
