// What is kept from run to run: nothing false, nothing of another build, and no person's work lost in silence.
#include <gmock/gmock.h>

#include "apps/small_cell.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class KeptResults : public ::testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  test::ProgramRun run(const std::string& arguments) const { return test::runProgram(folder_.path(), arguments); }

  test::TempFolder folder_;
};

TEST_F(KeptResults, AChangedResultIsToldAndKept) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners);
  ASSERT_EQ(run("run capture --out out").status, 0);
  const auto first = test::contentOf(path("out"));
  EXPECT_THAT(run("run capture --out out").err, Not(HasSubstr("was changed")));
  EXPECT_EQ(test::contentOf(path("out")), first);

  const std::string note = "# by hand\n" + readTextFile(path("out/model.yaml"));
  writeTextFile(path("out/model.yaml"), note);
  const test::ProgramRun again = run("run capture --out out");
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err,
              HasSubstr("poecal: warning: out/model.yaml was changed since it was written: it counts for nothing here, a copy is "
                        "kept in model.edited.yaml\n"));
  EXPECT_EQ(readTextFile(path("out/model.edited.yaml")), note);
  EXPECT_EQ(readTextFile(path("out/model.yaml")), first.at("model.yaml"));
  EXPECT_THAT(run("run capture --out out").err, Not(HasSubstr("was changed"))) << "once";

  writeTextFile(path("out/model.yaml"), "another one\n");
  EXPECT_THAT(run("run capture --out out").err, HasSubstr("kept in model.edited-2.yaml"));
  EXPECT_EQ(readTextFile(path("out/model.edited.yaml")), note) << "the first one is not lost either";
  EXPECT_EQ(readTextFile(path("out/model.edited-2.yaml")), "another one\n");
}

TEST_F(KeptResults, WhatACommandDoesNotWriteStaysChanged) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners);
  ASSERT_EQ(run("identify capture --out out").status, 0);
  writeTextFile(path("out/model.yaml"), "mine\n");
  for (int time = 0; time < 2; ++time) {
    EXPECT_THAT(run("measure capture --out out").err, HasSubstr("out/model.yaml was changed")) << time;
    EXPECT_EQ(readTextFile(path("out/model.yaml")), "mine\n");
  }
  EXPECT_FALSE(fs::exists(path("out/model.edited-2.yaml"))) << "the same copy";
}

TEST_F(KeptResults, CommandsAfterEachOtherDoNotTakeEachOthersForAPersons) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners);
  for (const char* command : {"run", "measure", "identify", "diagnose", "identify", "run"}) {
    const test::ProgramRun result = run(std::string(command) + " capture --out out");
    EXPECT_EQ(result.status, 0) << command << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("was changed"))) << command;
  }
}

TEST_F(KeptResults, AChangedLensIsFoundAgain) {
  test::writeSmallScene(folder_.path(), test::SmallCell::kPictures, "intrinsics: {target: board.yaml, count: 6}\n", 6);
  ASSERT_EQ(run("simulate scene/scene.yaml --out capture").status, 0);
  ASSERT_EQ(run("measure capture --out out").status, 0);
  const std::string camera = readTextFile(path("out/camera.yaml"));
  test::replaceInFile(path("out/camera.yaml"), "image_width: 400", "image_width: 401");
  const test::ProgramRun again = run("measure capture --out out");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("out/camera.yaml was changed since it was written"));
  EXPECT_EQ(readTextFile(path("out/camera.yaml")), camera);
  EXPECT_THAT(readTextFile(path("out/camera.edited.yaml")), HasSubstr("image_width: 401"));
  // Even where nobody has noted down how it was.
  fs::remove(path("out/.stages/results"));
  test::replaceInFile(path("out/camera.yaml"), "image_width: 400", "image_width: 402");
  EXPECT_EQ(run("measure capture --out out").status, 0);
  EXPECT_EQ(readTextFile(path("out/camera.yaml")), camera);
}

// A sanitizer needs more than what is given here.
#ifndef __SANITIZE_ADDRESS__
TEST_F(KeptResults, WithoutMemoryNothingFalseIsKept) {
  constexpr int kPictures = 3;
  test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures, kPictures);
  ASSERT_EQ(run("detect capture --jobs 1 --out whole/detections.csv").status, 0);
  const auto whole = test::contentOf(path("whole"));
  int refused = 0;
  for (int kilobytes = 120'000; kilobytes <= 400'000; kilobytes += 20'000) {
    const std::string out = "out-" + std::to_string(kilobytes);
    const test::ProgramRun little =
        test::runShell(folder_.path(), "( ulimit -v " + std::to_string(kilobytes) +
                                           "; '" POECAL_PROGRAM "' detect capture --jobs 1 --out " + out + "/detections.csv )");
    EXPECT_TRUE(little.status == 0 || !fs::exists(path(out + "/detections.csv"))) << kilobytes << little.err;
    EXPECT_NE(little.status, 4) << kilobytes << ": it is not known that there is no tag";
    if (little.status == 3) {
      EXPECT_THAT(little.err, HasSubstr("poecal: error: memory: there is not enough")) << kilobytes;
      ++refused;
    }
    ASSERT_EQ(run("detect capture --jobs 1 --out " + out + "/detections.csv").status, 0) << kilobytes;
    EXPECT_EQ(test::contentOf(path(out)), whole) << kilobytes;
  }
  EXPECT_GT(refused, 0) << "no limit was in the range where the program starts and has too little";
}
#endif

TEST_F(KeptResults, ASimulationThatWasKilledIsFinished) {
  test::writeSmallScene(folder_.path(), test::SmallCell::kPictures, "", 6);
  ASSERT_EQ(run("simulate scene/scene.yaml --out whole").status, 0);
  for (const int pictures : {0, 1, 3, 5}) {
    // Killed as soon as so many pictures are there.
    test::runShell(folder_.path(), "( '" POECAL_PROGRAM
                                   "' simulate scene/scene.yaml --jobs 1 --quiet --out out & "
                                   "while kill -0 $! && [ $(ls out/images/*.png | wc -l) -lt " +
                                       std::to_string(pictures) + " ]; do :; done; kill -9 $!; wait $! )");
    ASSERT_EQ(run("simulate scene/scene.yaml --out out").status,
              fs::exists(path("out/capture.yaml")) && !fs::exists(path("out/.unfinished")) ? 3 : 0)
        << pictures;
    EXPECT_EQ(test::contentOf(path("out")), test::contentOf(path("whole"))) << pictures;
    EXPECT_EQ(test::contentOf(path("out-truth")), test::contentOf(path("whole-truth"))) << pictures;
    fs::remove_all(path("out"));
    fs::remove_all(path("out-truth"));
  }
}

}  // namespace
}  // namespace poecal
