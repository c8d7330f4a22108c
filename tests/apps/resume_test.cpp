// A killed command goes on where it was, and pictures searched in parts give what one run gives.
#include <algorithm>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/detection/detect_capture.hpp"
#include "poecal/detection/known_corners.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

constexpr int kPoses = 10;

/// A capture of pictures whose third one shows nothing, so that there is a note as well.
class Resume : public ::testing::Test {
 protected:
  Resume() {
    test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures, kPoses);
    writeTextFile(path("capture/images/0002.png"), "no picture");
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  test::ProgramRun run(const std::string& arguments) const {
    test::ProgramRun result = test::runProgram(folder_.path(), arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result;
  }
  /// `known_before` of a `detect`.
  int knownBefore(const std::string& arguments) const { return nlohmann::json::parse(run(arguments + " --json").out)["known_before"]; }
  std::string text(const std::string& name) const { return readTextFile(path(name)); }

  test::TempFolder folder_;
};

TEST_F(Resume, DetectGoesOnWhereItWasKilled) {
  const test::ProgramRun fresh = run("detect capture --out fresh/detections.csv");
  EXPECT_THAT(fresh.err, HasSubstr("images/0002.png: is not a picture"));
  const std::string known = text("fresh/.stages/corners");
  for (const std::string jobs : {"1", "2"}) {
    // In the middle of a line.
    const std::size_t cut = known.find('\n', known.size() / 2) + 50;
    const auto whole_lines = std::count(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(cut), '\n') - 1;
    writeTextFile(path("killed/.stages/corners"), known.substr(0, cut));
    const test::ProgramRun resumed = run("detect capture --out killed/detections.csv --json --jobs " + jobs);
    EXPECT_EQ(nlohmann::json::parse(resumed.out)["known_before"], whole_lines);
    EXPECT_EQ(resumed.err, fresh.err);
    EXPECT_EQ(test::contentOf(path("killed")), test::contentOf(path("fresh"))) << "jobs " << jobs;
  }
}

TEST_F(Resume, OnlyNewAndChangedPicturesAreSearched) {
  EXPECT_EQ(knownBefore("detect capture --out out/detections.csv"), 0);
  EXPECT_EQ(knownBefore("detect capture --out out/detections.csv"), kPoses - 1);
  const std::string rows = text("capture/samples.csv");
  test::rewriteCsv(path("capture/samples.csv"), [](test::Rows& table) { table.erase(table.begin() + 2); });
  EXPECT_EQ(knownBefore("detect capture --out out/detections.csv"), kPoses - 2) << "a row less";
  writeTextFile(path("capture/samples.csv"), rows);
  EXPECT_EQ(knownBefore("detect capture --out out/detections.csv"), kPoses - 2) << "and one more";
  fs::copy_file(path("capture/images/0004.png"), path("capture/images/0005.png"), fs::copy_options::overwrite_existing);
  writeTextFile(path("capture/images/0006.png"), text("capture/images/0006.png") + "padding");
  EXPECT_EQ(knownBefore("detect capture --out out/detections.csv"), kPoses - 3) << "0005.png is the same picture as 0004.png";
}

TEST_F(Resume, OtherOptionsSearchAgain) {
  const std::string detect = "detect capture --out out/detections.csv";
  knownBefore(detect);
  EXPECT_EQ(knownBefore(detect + " --no-refine"), 0);
  EXPECT_EQ(knownBefore(detect + " --no-refine --quad-decimate 1"), 0);
  EXPECT_EQ(knownBefore(detect), 0);
  test::replaceInFile(path("capture/camera.yaml"), "694.35", "694.36");
  EXPECT_EQ(knownBefore(detect), 0) << "another lens";
  test::replaceInFile(path("capture/target.yaml"), "size: 0.12", "size: 0.121");
  EXPECT_EQ(knownBefore(detect), 0) << "another target";
}

TEST_F(Resume, LaterStagesSearchNothingThatDetectHasSearched) {
  run("detect capture --out out/detections.csv");
  const std::string real = text("out/detections.csv");
  const Capture capture = readCapture(path("capture"));
  DetectOptions options;
  options.camera = capture.camera;
  const std::string key = pictureKey(detectionKey(capture.target, options), text("capture/images/0001.png"));
  {
    KnownCorners known(path("out/.stages/corners"));
    std::optional<PictureFinding> finding = known.find(key);
    ASSERT_TRUE(finding);
    finding->corners[0].px.x() = 123.0625;
    known.add(key, *finding);
  }
  for (const std::string stage : {"measure", "identify", "run"}) {
    run(stage + " capture --out out");
    EXPECT_THAT(text("out/detections.csv"), HasSubstr("123.0625")) << stage;
    writeTextFile(path("out/detections.csv"), real);
  }
}

TEST_F(Resume, PartsMakeOneDetection) {
  run("detect capture --out whole/detections.csv");
  std::string parts;
  std::size_t pictures = 0;
  for (int part = 1; part <= 3; ++part) {
    const std::string out = std::to_string(part) + ".corners";
    const test::ProgramRun result = run("detect capture --part " + std::to_string(part) + "/3 --json --out " + out);
    pictures += nlohmann::json::parse(result.out)["pictures"].get<std::size_t>();
    parts += " " + out;
  }
  EXPECT_EQ(pictures, static_cast<std::size_t>(kPoses)) << "each in one part";
  EXPECT_EQ(knownBefore("detect capture --out joined/detections.csv --known" + parts), kPoses - 1);
  EXPECT_EQ(test::contentOf(path("joined")), test::contentOf(path("whole")));
  EXPECT_EQ(knownBefore("detect capture --out less/detections.csv --known 1.corners 3.corners"), 6) << "what is missing is searched";
  EXPECT_EQ(text("less/detections.csv"), text("whole/detections.csv"));
}

TEST_F(Resume, MorePartsThanPicturesLeaveSomeEmpty) {
  std::string parts;
  for (int part = 1; part <= kPoses + 3; ++part) {
    const std::string out = std::to_string(part) + ".corners";
    run("detect capture --quiet --part " + std::to_string(part) + "/" + std::to_string(kPoses + 3) + " --out " + out);
    parts += " " + out;
  }
  EXPECT_EQ(knownBefore("detect capture --out out/detections.csv --known" + parts), kPoses - 1);
}

TEST_F(Resume, DetectionsOfBeforeNeedNoPictures) {
  run("run capture --out out");
  fs::remove_all(path("capture/images"));
  run("run capture --detections out/detections.csv --out again");
  for (const char* file : {"registration.yaml", "flange_poses.csv", "model.yaml", "identification.json"}) {
    EXPECT_EQ(text(std::string("again/") + file), text(std::string("out/") + file)) << file;
  }
}

TEST(DetectParts, AWrongPartIsAWrongCall) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kCorners, 3);
  for (const std::string part : {"0/2", "3/2", "1", "1/", "/2", "1/2/3", "-1/2", "a/b", "1/0", "1 /2"}) {
    const test::ProgramRun run = test::runProgram(folder.path(), "detect capture --out a.corners --part '" + part + "'");
    EXPECT_EQ(run.status, 2) << part;
    EXPECT_THAT(run.err, HasSubstr("--part is '" + part + "', expected K/N")) << part;
  }
  EXPECT_FALSE(fs::exists(folder.path() / "a.corners"));
}

TEST(DetectParts, AFileOfAnotherKindIsNamed) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kCorners, 3);
  const test::ProgramRun run = test::runProgram(folder.path(), "detect capture --out a.csv --known capture/samples.csv");
  EXPECT_EQ(run.status, 3);
  EXPECT_THAT(run.err, HasSubstr("samples.csv:1: is not a file of known corners"));
}

}  // namespace
}  // namespace poecal
