// poecal intrinsics on tags, whose edges are as the lens bends them.
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>

#include "apps/small_cell.hpp"
#include "poecal/camera/camera.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/statistics.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

TEST(IntrinsicsCommand, TagsAreFittedOnceMoreWithTheLensThatTheyGave) {
  // [px]; noise leaves 0.0065, tags whose edges are taken as straight 0.019.
  constexpr double kMedianRms = 0.01;
  constexpr double kDeviations = 3.0;
  const test::TempFolder folder;
  test::writeSmallScene(folder.path(), test::SmallCell::kPictures, "intrinsics: {target: grid.yaml, count: 12}\n", 1);
  test::replaceInFile(folder.path() / "scene/scene.yaml", "seed: 12", "seed: 2");
  test::replaceInFile(folder.path() / "scene/camera.yaml", "-0.081, 0.057", "-0.25, 0.08");
  folder.write("scene/grid.yaml", "type: aprilgrid\ntagCols: 3\ntagRows: 2\ntagSize: 0.08\ntagSpacing: 0.3\nfirstId: 0\n");
  ASSERT_EQ(test::runProgram(folder.path(), "simulate scene/scene.yaml --out capture").status, 0);
  const test::ProgramRun run = test::runProgram(folder.path(), "intrinsics capture/intrinsics --out camera.yaml");
  ASSERT_EQ(run.status, 0) << run.err;
  const CsvTable residuals = CsvTable::read(folder.path() / "camera-residuals.csv");
  std::vector<double> rms;
  for (std::size_t row = 0; row < residuals.rowCount(); ++row) rms.push_back(residuals.number(row, residuals.column("rms_px")));
  EXPECT_LT(median(rms), kMedianRms);
  const Camera found = readCamera(folder.path() / "camera.yaml"), truth = readCamera(folder.path() / "capture-truth/camera.yaml");
  EXPECT_LT(std::abs(found.fx - truth.fx), kDeviations * found.standard_deviation(0));
  EXPECT_LT(std::abs(found.fy - truth.fy), kDeviations * found.standard_deviation(1));
}

/// Pictures of a chessboard of 6 x 5 inner corners in capture/intrinsics.
void simulateBoardPictures(const test::TempFolder& folder) {
  test::writeSmallScene(folder.path(), test::SmallCell::kPictures, "intrinsics: {target: board.yaml, count: 6}\n", 1);
  folder.write("scene/board.yaml", "type: chessboard\ncols: 6\nrows: 5\nsquare: 0.06\n");
  ASSERT_EQ(test::runProgram(folder.path(), "simulate scene/scene.yaml --out capture").status, 0);
}

TEST(IntrinsicsCommand, WhyItFailsIsSaidPictureByPicture) {
  const test::TempFolder folder;
  simulateBoardPictures(folder);
  folder.write("capture/intrinsics/target.yaml", "type: chessboard\ncols: 7\nrows: 6\nsquare: 0.06\n");
  const test::ProgramRun run = test::runProgram(folder.path(), "intrinsics capture/intrinsics --out camera.yaml");
  EXPECT_EQ(run.status, 4);
  EXPECT_THAT(run.err,
              testing::HasSubstr("no chessboard of 7 x 6 inner corners was found; one of 6 x 5 was: cols and rows count inner corners"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "camera.yaml"));
}

TEST(IntrinsicsCommand, CoefficientsThatAnyValueFitsAreHeldAndSaid) {
  const test::TempFolder folder;
  simulateBoardPictures(folder);
  const test::ProgramRun run =
      test::runProgram(folder.path(), "intrinsics capture/intrinsics --model rational_polynomial --out camera.yaml");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, testing::HasSubstr("held: any value fits"));
  EXPECT_THAT(run.out, testing::Not(testing::HasSubstr("nan")));
  EXPECT_THAT(run.out, testing::HasSubstr("projection: 1 sigma is"));
  EXPECT_EQ(readCamera(folder.path() / "camera.yaml").distortion(7), 0.0) << "k6";
}

}  // namespace
}  // namespace poecal
