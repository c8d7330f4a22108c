// README.md shows the program that is built and run, and the help shows what README does.
#include <gmock/gmock.h>

#include "poecal/core/text.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal::test {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kProject = POECAL_SOURCE_DIR;

std::string readme() { return readTextFile(kProject / "README.md"); }

/// The lines of `text` that hold `word`, without the blanks before them.
std::vector<std::string> linesWith(const std::string& text, const std::string& word) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string::npos && line.find(word) != std::string::npos) lines.push_back(line.substr(first));
    begin = end + 1;
  }
  return lines;
}

TEST(Readme, ShowsTheExamplesThatAreRun) {
  EXPECT_THAT(readme(), HasSubstr("```cpp\n" + readTextFile(kProject / "tests/consumer/project/calibrate.cpp") + "```\n"));
  EXPECT_THAT(readme(), HasSubstr("```python\n" + readTextFile(kProject / "tests/python/readme_example.py") + "```\n"));
}

// Figures of the help and of README are of the same runs: whoever renews one of them renews the other.
TEST(Readme, HasTheFiguresOfTheHelp) {
  const TempFolder folder;
  for (const char* command : {"run", "identify", "measure", "fleet", "diagnose"}) {
    const std::string help = runProgram(folder.path(), std::string(command) + " --help").out;
    int shown = 0;
    for (const char* word : {"nominal  ", "identified  ", "camera in base", "cell-1 ", "cell-2 ", "cell-3 ", "ratio 0.", "how far:"}) {
      for (const std::string& line : linesWith(help, word)) {
        EXPECT_THAT(readme(), HasSubstr(line)) << command;
        ++shown;
      }
    }
    EXPECT_GT(shown, 0) << command;
  }
}

}  // namespace
}  // namespace poecal::test
