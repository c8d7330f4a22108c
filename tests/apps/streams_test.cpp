// The exit status says what happened, whatever stdout and stderr are.
#include <gmock/gmock.h>

#include "apps/small_cell.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// `poecal ARGUMENTS` with redirections of its own.
test::ProgramRun run(const test::TempFolder& folder, const std::string& arguments, const std::string& redirections) {
  return test::runShell(folder.path(), "( '" POECAL_PROGRAM "' " + arguments + " " + redirections + " )");
}

TEST(Streams, AnErrorKeepsItsStatusWithoutStderr) {
  const test::TempFolder folder;
  for (const char* redirection : {"2>&-", "2>/dev/full", "2>/dev/full >&-", "<&- >&- 2>&-"}) {
    EXPECT_EQ(run(folder, "nonsense", redirection).status, 2) << redirection;
    EXPECT_EQ(run(folder, "effects no_effect", redirection).status, 2) << redirection;
    EXPECT_EQ(run(folder, "measure nowhere --out out", redirection).status, 3) << redirection;
  }
}

TEST(Streams, ASummaryThatCannotBeWrittenIsAnError) {
  const test::TempFolder folder;
  for (const char* arguments : {"effects", "effects --json", "effects joint_gain", "--help", "run --help", "--version"}) {
    const test::ProgramRun full = run(folder, arguments, ">/dev/full");
    EXPECT_EQ(full.status, 3) << arguments;
    EXPECT_EQ(full.err, "poecal: error: stdout: cannot be written: No space left on device\n") << arguments;
    const test::ProgramRun closed = run(folder, arguments, ">&-");
    EXPECT_EQ(closed.status, 3) << arguments;
    EXPECT_THAT(closed.err, StartsWith("poecal: error: stdout: cannot be written: ")) << arguments;
  }
}

TEST(Streams, WhereNothingIsPrintedNothingIsMissed) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kCorners);
  EXPECT_EQ(run(folder, "measure capture --out quiet --quiet", ">/dev/full").status, 0);
  EXPECT_EQ(run(folder, "measure capture --out told", ">/dev/full").status, 3);
  EXPECT_EQ(readTextFile(folder.path() / "told/registration.yaml"), readTextFile(folder.path() / "quiet/registration.yaml"))
      << "the results are there all the same";
}

TEST(Streams, WhatIsPrintedDoesNotEnterFilesWhereStreamsAreClosed) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kPictures, 4);
  writeTextFile(folder.path() / "capture/images/0002.png", "no picture: there is a warning");
  ASSERT_EQ(test::runProgram(folder.path(), "detect capture --out open/detections.csv").status, 0);
  EXPECT_EQ(run(folder, "detect capture --out closed/detections.csv", "<&- >&- 2>&-").status, 3);
  EXPECT_EQ(test::contentOf(folder.path() / "closed"), test::contentOf(folder.path() / "open"));
}

}  // namespace
}  // namespace poecal
