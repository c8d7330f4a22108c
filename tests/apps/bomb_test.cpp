// Pictures that state a size, and say nothing else: they are judged by that before they take memory and time.
#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/small_cell.hpp"
#include "poecal/capture/capture.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

/// A PGM whose header promises more than a machine holds, with nothing behind it but a hole.
void writePromise(const fs::path& file, int width, int height, std::uintmax_t size) {
  writeTextFile(file, "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n");
  fs::resize_file(file, size);
}

TEST(Bomb, OfAnotherSizeThanTheCameraIsNotDecoded) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kPictures, 4);
  const fs::path picture = folder.path() / "capture" / readCapture(folder.path() / "capture").table.samples[2].image;
  writePromise(picture, 30'000, 30'000, 1'000'000);
  // What decoding took would be 900 MB alone.
  const test::ProgramRun run = test::runProgram(folder.path(), "detect capture --out detections.csv");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("0002.png: is 30000 x 30000 pixels, expected 400 x 300"));
  EXPECT_THAT(run.out, HasSubstr("3 of 4 pictures"));
}

TEST(Bomb, AmongPicturesOfABoardIsTheOddOne) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kPictures, 4);
  const fs::path board = folder.path() / "board";
  fs::create_directory(board);
  fs::copy_file(folder.path() / "capture/target.yaml", board / "target.yaml");
  for (const char* name : {"0000.png", "0001.png", "0002.png"}) fs::copy_file(folder.path() / "capture/images" / name, board / name);
  writePromise(board / "000.png", 14'000, 14'000, 1000);
  writePromise(board / "zzz.png", 100'000, 100'000, 1000);
  const test::ProgramRun run = test::runProgram(folder.path(), "intrinsics board --out camera.yaml");
  EXPECT_NE(run.status, 1) << run.err;
  EXPECT_LT(run.status, 5) << run.err;
  EXPECT_FALSE(fs::exists(folder.path() / "camera.yaml") && run.status != 0);
}

TEST(Bomb, ALinkToItselfIsOneBadPictureOfMany) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kPictures, 4);
  const fs::path capture = folder.path() / "capture";
  const std::vector<Sample> samples = readCapture(capture).table.samples;
  fs::remove(capture / samples[1].image);
  fs::create_symlink(fs::path(samples[1].image).filename(), capture / samples[1].image);
  fs::remove(capture / samples[2].image);
  fs::create_directory(capture / samples[2].image);
  const test::ProgramRun run = test::runProgram(folder.path(), "detect capture --out detections.csv");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr(samples[1].image + ": cannot be read: Too many levels of symbolic links"));
  EXPECT_THAT(run.err, HasSubstr(samples[2].image + ": is a folder, expected a file"));
  EXPECT_THAT(run.out, HasSubstr("2 of 4 pictures"));
}

}  // namespace
}  // namespace poecal
