// What `completion` writes, opened by bash, zsh and man themselves.
#include <gmock/gmock.h>

#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Completion : public ::testing::Test {
 protected:
  test::ProgramRun shell(const std::string& command) const { return test::runShell(folder_.path(), command); }
  bool has(const std::string& program) const { return shell("command -v " + program).status == 0; }
  void SetUp() override {
    for (const char* kind : {"bash", "zsh", "man"}) {
      const test::ProgramRun result = test::runProgram(folder_.path(), std::string("completion ") + kind);
      ASSERT_EQ(result.status, 0) << result.err;
      folder_.write(std::string(kind) + ".txt", result.out);
    }
  }
  /// What bash offers for the last of some words.
  std::string offered(const std::string& words, int last) const {
    const std::string script =
        "source ./bash.txt; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(last) + "; _poecal; echo \"${COMPREPLY[*]}\"";
    return shell("bash -c '" + script + "'").out;
  }

  test::TempFolder folder_;
};

TEST_F(Completion, OfBashOffersCommandsAndTheirOptions) {
  EXPECT_EQ(offered("poecal iden", 1), "identify\n");
  EXPECT_THAT(offered("poecal \"\"", 1), HasSubstr("run target new check simulate"));
  EXPECT_EQ(offered("poecal --jobs 2 run capture --ou", 5), "--out\n");
  EXPECT_THAT(offered("poecal diagnose --", 2), HasSubstr("--explain"));
  EXPECT_EQ(offered("poecal run cap", 2), "\n") << "files are left to bash";
}

TEST_F(Completion, OfZshIsWellFormed) {
  if (!has("zsh")) GTEST_SKIP() << "zsh is not installed";
  const test::ProgramRun result = shell("zsh -n zsh.txt");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(Completion, ManualPageIsRenderedWithoutAWarning) {
  if (!has("man")) GTEST_SKIP() << "man is not installed";
  const test::ProgramRun result = shell("LC_ALL=C.UTF-8 MANWIDTH=100 man --warnings -P cat -l ./man.txt");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, HasSubstr("diagnose"));
  EXPECT_THAT(result.out, HasSubstr("$ poecal run capture --out out"));
  EXPECT_THAT(result.out, Not(HasSubstr(".TP")));
}

}  // namespace
}  // namespace poecal
