// poecal target: what is written, and what is refused.
#include <gmock/gmock.h>

#include "poecal/target/target.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::StartsWith;

class TargetCommand : public ::testing::Test {
 protected:
  test::ProgramRun run(const std::string& options) { return test::runProgram(folder_.path(), "target " + options); }
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  test::TempFolder folder_;
};

TEST_F(TargetCommand, WritesWhatAPrinterAndACaptureNeed) {
  const test::ProgramRun result = run("--type apriltag --id 7 --size 0.08 --out tag");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out,
            "tag/target.svg, tag/target.pdf, tag/target.yaml\n"
            "1 page of 210 x 297 mm. Print at 100 %, then measure both rulers: 100 mm each\n");
  EXPECT_THAT(readTextFile(path("tag/target.pdf")), StartsWith("%PDF-"));
  EXPECT_THAT(readTextFile(path("tag/target.svg")), HasSubstr("width=\"210mm\" height=\"297mm\""));
  const Target target = readTarget(path("tag/target.yaml"));
  EXPECT_EQ(target.tags.at(0).id, 7);
  EXPECT_EQ(target.tags.at(0).size, 0.08);
}

TEST_F(TargetCommand, EveryTypeAndAFileOfOnesOwn) {
  for (const char* options : {"--type aprilgrid --cols 3 --rows 2 --size 0.04 --spacing 0.25 --id 4 --border-bits 2",
                              "--type charuco --cols 7 --rows 5 --square 0.03 --marker 0.022 --dictionary DICT_5X5_100",
                              "--type chessboard --cols 8 --rows 5 --square 0.025 --paper a3"}) {
    const test::ProgramRun first = run(std::string(options) + " --out a.svg");
    ASSERT_EQ(first.status, 0) << first.err;
    ASSERT_EQ(run("--file a.yaml --paper a3 --out b.svg").status, 0);
    EXPECT_EQ(readTextFile(path("a.yaml")), readTextFile(path("b.yaml")));
  }
}

TEST_F(TargetCommand, AnInputIsNotReplaced) {
  ASSERT_EQ(run("--type apriltag --id 7 --size 0.08 --out tag.svg").status, 0);
  const test::ProgramRun result = run("--file tag.yaml --out tag.svg");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("tag.yaml"));
}

TEST_F(TargetCommand, AFileOfATagThatNobodyCanPrintIsRefused) {
  folder_.write("tiny.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n  - {id: 7, size: 0.0001}\n");
  const test::ProgramRun result = run("--file tiny.yaml --out tag");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("tiny.yaml: tag 7 of 0.1 mm cannot be printed, expected 2 mm or more"));
  EXPECT_FALSE(fs::exists(path("tag")));
}

TEST_F(TargetCommand, WhatIsMissingOrTooLargeIsSaid) {
  const auto expectRefused = [this](const std::string& options, int status, const std::string& message) {
    const test::ProgramRun result = run(options + " --out tag");
    EXPECT_EQ(result.status, status) << options;
    EXPECT_THAT(result.err, HasSubstr(message)) << options;
    EXPECT_FALSE(fs::exists(path("tag"))) << options;
  };
  expectRefused("", 2, "target needs --type or --file");
  expectRefused("--type apriltag --id 7", 2, "--type apriltag needs --size");
  expectRefused("--type charuco --cols 5 --rows 4", 2, "--type charuco needs --square");
  expectRefused("--type points", 2, "single points cannot be printed");
  expectRefused("--type star", 2, "expected apriltag");
  expectRefused("--type apriltag --id 7 --size -1", 2, "size");
  expectRefused("--type apriltag --id 7 --size 0.0008", 2, "expected 0.002 to 3 m");
  expectRefused("--type aprilgrid --cols 3 --rows 2 --size 0.02 --spacing 0.006", 2, "expected 0.05 to 5 of a tag's size");
  expectRefused("--type chessboard --cols 5 --rows 4 --square 0.0005", 2, "expected 0.002 to 3 m");
  expectRefused("--type apriltag --id 7000 --size 0.1", 2, "7000");
  expectRefused("--type apriltag --id 7 --size 0.3", 2, "--paper a1 holds it");
  expectRefused("--type apriltag --id 7 --size 0.1 --paper a9", 2, "paper 'a9'");
  folder_.write("points.yaml",
                "type: points\npoints:\n  - {id: 1, position: [0, 0, 0]}\n  - {id: 2, position: [1, 0, 0]}\n"
                "  - {id: 3, position: [0, 1, 0]}\n");
  expectRefused("--file points.yaml", 2, "single points");
  expectRefused("--file nothing.yaml", 3, "nothing.yaml");
}

}  // namespace
}  // namespace poecal
