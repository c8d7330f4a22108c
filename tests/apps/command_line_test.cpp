// What holds for every command, whatever it does.
#include <gmock/gmock.h>

#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class CommandLine : public ::testing::Test {
 protected:
  test::ProgramRun run(const std::string& arguments) { return test::runProgram(folder_.path(), arguments); }
  /// One line on stderr, nothing on stdout, status 2.
  void expectWrong(const std::string& arguments, const std::string& message) {
    const test::ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_THAT(result.out, IsEmpty()) << arguments;
    EXPECT_THAT(result.err, StartsWith("poecal: error: ")) << arguments;
    EXPECT_THAT(result.err, HasSubstr(message)) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }

  test::TempFolder folder_;
};

TEST_F(CommandLine, VersionIsThatOfTheProject) {
  const test::ProgramRun result = run("--version");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "poecal " POECAL_VERSION "\n");
}

TEST_F(CommandLine, HelpListsEveryCommand) {
  const test::ProgramRun result = run("--help");
  EXPECT_EQ(result.status, 0);
  for (const char* name :
       {"run", "intrinsics", "detect", "measure", "identify", "diagnose", "predict", "simulate", "plan", "effects", "export", "report"}) {
    EXPECT_THAT(result.out, HasSubstr(std::string("\n  ") + name + " ")) << name;
  }
}

TEST_F(CommandLine, AnUnknownCommandNamesTheNearest) {
  expectWrong("idnetify capture --out out", "did you mean identify?");
  expectWrong("diagnos", "did you mean diagnose?");
  expectWrong("--jobs 2 rum capture", "did you mean run?");
}

TEST_F(CommandLine, MistakesAreStatusTwo) {
  expectWrong("", "a command is missing");
  expectWrong("calibrate", "calibrate");
  expectWrong("--fast", "--fast");
  expectWrong("run capture --out out --fast", "--fast");
  expectWrong("run capture", "--out is required");
  expectWrong("run", "CAPTURE is required");
  expectWrong("run capture --out out --jobs -1", "--jobs");
  expectWrong("run capture --out out --method newton", "newton");
  expectWrong("identify --out out", "CAPTURE");
  expectWrong("predict --model model.yaml --out next.csv", "CAPTURE");
}

TEST_F(CommandLine, NumbersThatNobodyHasAreStatusTwo) {
  const std::string plan = "plan --robot arm.urdf --camera camera.yaml --target target.yaml --camera-at 0 0 1 --out next.csv ";
  expectWrong(plan + "--floor inf", "--floor: 'inf': expected a number from -1e9 to 1e9");
  expectWrong(plan + "--corner-sigma nan", "--corner-sigma: 'nan': expected a number above 0");
  expectWrong(plan + "--corner-sigma 1e300", "--corner-sigma: '1e300': expected a number from -1e9 to 1e9");
  expectWrong(plan + "--look-at 0 nan 0", "--look-at: 'nan': expected a number from -1e9 to 1e9");
  expectWrong(plan + "--rough-position 0", "--rough-position: '0': expected a number above 0");
  expectWrong(plan + "--link-radius=-1", "--link-radius: '-1': expected 0 or a number above it");
}

class EachCommand : public ::testing::TestWithParam<const char*> {};

TEST_P(EachCommand, HelpShowsARun) {
  const test::TempFolder folder;
  const test::ProgramRun result = test::runProgram(folder.path(), std::string(GetParam()) + " --help");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, HasSubstr("Example:\n  $ poecal " + std::string(GetParam()) + " "));
}

INSTANTIATE_TEST_SUITE_P(All, EachCommand,
                         ::testing::Values("run", "simulate", "intrinsics", "detect", "measure", "identify", "diagnose", "predict",
                                           "compensate", "effects", "export", "fleet", "paper", "plan", "target", "new", "check", "report",
                                           "completion"),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace poecal
