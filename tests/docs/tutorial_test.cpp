// TUTORIAL.md does what it shows: its commands run, answer as it says, and its tables are of the report and of the effects.
#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>

#include "docs/page.hpp"
#include "poecal/core/text.hpp"
#include "poecal/effects/catalogue.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

const fs::path kProject = POECAL_SOURCE_DIR;
const std::string kPrompt = "$ poecal ";
constexpr const char* kLeftOut = "...";

Page tutorial() { return readPage(kProject / "calib_data/TUTORIAL.md"); }

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Cells of the tables of a section, without their heads.
std::vector<std::vector<std::string>> tableRows(const Section& section) {
  std::vector<std::vector<std::string>> rows;
  bool head = true;
  for (const std::string& line : linesOf(section.text)) {
    if (!line.starts_with("|")) head = true;
    if (line.starts_with("|--")) {
      head = false;
    } else if (line.starts_with("|") && !head) {
      std::vector<std::string>& cells = rows.emplace_back();
      std::istringstream stream(line.substr(1));
      for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(cell.substr(1, cell.size() - 2));
    }
  }
  return rows;
}

/// The lines that a page shows, each where it stands in the answer; "..." stands for any lines.
void expectAnswer(const std::vector<std::string>& shown, const std::vector<std::string>& answer, const std::string& command) {
  std::size_t next = 0;
  bool gap = false;
  for (const std::string& line : shown) {
    if (line == kLeftOut) {
      gap = true;
      continue;
    }
    if (gap)
      next = static_cast<std::size_t>(std::find(answer.begin() + static_cast<std::ptrdiff_t>(next), answer.end(), line) - answer.begin());
    ASSERT_LT(next, answer.size()) << command << "\ndoes not answer: " << line;
    EXPECT_EQ(answer[next], line) << command;
    ++next;
    gap = false;
  }
  EXPECT_TRUE(gap || next == answer.size()) << command << "\nanswers more: " << answer[std::min(next, answer.size() - 1)];
}

/// The folder in which the page's reader stands.
void prepare(const TempFolder& folder) {
  fs::create_directories(folder.path() / "calib_data");
  fs::copy(kProject / "calib_data/cobot6", folder.path() / "calib_data/cobot6");
  fs::copy_file(kProject / "calib_data/cobot6/cobot6.urdf", folder.path() / "my-arm.urdf");
}

TEST(Tutorial, ItsCommandsAnswerAsItShows) {
  const TempFolder folder;
  prepare(folder);
  int commands = 0;
  for (const Example& example : tutorial().examples) {
    ASSERT_EQ(example.language, "console");
    const std::vector<std::string> lines = linesOf(example.text);
    ASSERT_THAT(lines.front(), ::testing::StartsWith(kPrompt)) << "one command to a block, and its answer";
    const ProgramRun run = runProgram(folder.path(), lines.front().substr(kPrompt.size()));
    EXPECT_EQ(run.status, 0) << lines.front() << "\n" << run.err;
    expectAnswer({lines.begin() + 1, lines.end()}, linesOf(run.err + run.out), lines.front());
    ++commands;
  }
  EXPECT_GE(commands, 11);
  // Its charts are those of the page that was written on the way.
  const std::string page = readTextFile(folder.path() / "out/report.html");
  const Page text = tutorial();
  for (const std::vector<std::string>& row : tableRows(text.section("Read the report"))) EXPECT_THAT(page, HasSubstr(row[0] + "'"));
  for (const std::vector<std::string>& row : tableRows(text.section("What each bad pattern means"))) {
    EXPECT_THAT(page, HasSubstr(row[1] + "'"));
  }
}

TEST(Tutorial, SaysOfEachPatternWhatTheEffectSays) {
  int effects = 0;
  const Page page = tutorial();
  for (const std::vector<std::string>& row : tableRows(page.section("What each bad pattern means"))) {
    ASSERT_EQ(row.size(), 4);
    const std::vector<std::string> names = codeOf(row[2]);
    if (names.empty() || names.front() == kUnknownEffect) continue;
    EXPECT_EQ(row[3], effectKind(names.front()).remedy) << names.front();
    ++effects;
  }
  EXPECT_GE(effects, 15);
}

TEST(Tutorial, NamesCommandsAndOptionsThatAreThere) {
  const TempFolder folder;
  int named = 0;
  for (const Section& section : tutorial().sections) {
    for (const std::string& code : codeOf(section.text)) {
      if (!code.starts_with("poecal ")) continue;
      std::istringstream words(code.substr(std::string("poecal ").size()));
      std::string command, option;
      words >> command;
      const ProgramRun help = runProgram(folder.path(), command + " --help");
      EXPECT_EQ(help.status, 0) << code;
      while (words >> option) EXPECT_THAT(help.out, HasSubstr(option + " ")) << code;
      ++named;
    }
  }
  EXPECT_GE(named, 5);
}

}  // namespace
}  // namespace poecal::test
