// On a terminal: one line of progress, colours. Elsewhere: neither.
#include "support/terminal.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "progress_line.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"
#include "terminal.hpp"

namespace poecal {
namespace {

using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;
using ::testing::StartsWith;

const std::string kProgram = "'" POECAL_PROGRAM "' ";
constexpr const char* kEscape = "\033";
constexpr const char* kBold = "\033[1m";
constexpr const char* kRed = "\033[31m";
constexpr const char* kClearLine = "\r\033[K";

TEST(ProgressLine, SaysTheTimeLeftOnceTheRateIsKnown) {
  app::ProgressLine line;
  EXPECT_THAT(line.text("detecting", 1, 101, 10.0, 80), Optional(Eq("detecting: 1 of 101")));
  EXPECT_THAT(line.text("detecting", 3, 101, 12.0, 80), Optional(Eq("detecting: 3 of 101")));
  // 10 pieces in 4 s: 90 more take 36 s.
  EXPECT_THAT(line.text("detecting", 11, 101, 14.0, 80), Optional(Eq("detecting: 11 of 101, about 40 s left")));
  EXPECT_EQ(line.text("detecting", 12, 101, 14.05, 80), std::nullopt) << "too soon to be read";
  EXPECT_EQ(line.text("detecting", 101, 101, 15.0, 80), std::nullopt) << "done";
  EXPECT_THAT(line.text("fitting", 0, 6, 15.0, 80), Optional(Eq("fitting: 0 of 6"))) << "the next job begins with a clock of its own";
}

TEST(ProgressLine, StaysWithinTheTerminal) {
  app::ProgressLine line;
  EXPECT_THAT(line.text("a label that is far too long", 1, 2, 0.0, 24), Optional(Eq("a label that is far ...")));
}

TEST(ProgressLine, RoundsUp) {
  EXPECT_EQ(app::timeLeftText(0.2), "about 5 s left");
  EXPECT_EQ(app::timeLeftText(41.0), "about 45 s left");
  EXPECT_EQ(app::timeLeftText(100.0), "about 2 min left");
  EXPECT_EQ(app::timeLeftText(6000.0), "about 2 h left");
}

TEST(Warnings, EqualOnesArePrintedOnce) {
  std::vector<std::string> messages(20, "a skew is dropped");
  messages.insert(messages.begin() + 7, "another");
  app::TerminalListener listener(app::Common{});
  ::testing::internal::CaptureStderr();
  listener.warnings(messages);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "poecal: warning: a skew is dropped (20 times)\npoecal: warning: another\n");
}

/// What is said with --json of JSON text, or of an object.
std::string printedJson(const std::string& json) {
  ::testing::internal::CaptureStdout();
  app::printReport({.json = true}, "text", json);
  return ::testing::internal::GetCapturedStdout();
}
std::string printedJson(const nlohmann::json& json) {
  ::testing::internal::CaptureStdout();
  app::printSummary({.json = true}, "text", json);
  return ::testing::internal::GetCapturedStdout();
}

TEST(Json, OfPartsIsWhatOneWriterWrites) {
  using Object = nlohmann::ordered_json;
  const Object first{{"name", "Schw\u00e4nker\nof \"two\" lines"}, {"list", {1, 2.5, nullptr}}, {"none", Object::object()}},
      second{{"a", {{"b", {}}}}};
  const Object whole{{"first", first}, {"second", second}, {"third", 3}};
  const std::string parts = app::jsonObject({{"first", first.dump(2)}, {"second", second.dump(2) + "\n"}, {"third", "3\n"}});
  EXPECT_EQ(parts, whole.dump(2) + "\n");
  EXPECT_EQ(printedJson(parts), whole.dump(2, ' ', true) + "\n");
}

TEST(Json, OfAnObjectAndOfItsTextAreAlike) {
  const nlohmann::json json{{"folder", "\u00fcber\x7f/\U0001F916"}, {"files", {"a", "b"}}};
  EXPECT_EQ(printedJson(json), printedJson(json.dump(2) + "\n"));
}

class Terminal : public ::testing::Test {
 protected:
  Terminal() { test::simulateSmallCell(folder_.path(), test::SmallCell::kCorners, 16); }
  test::TempFolder folder_;
};

TEST_F(Terminal, EveryStepOfARunTellsHowFarItIs) {
  const std::string seen = test::runInTerminal(folder_.path(), kProgram + "run capture --out out");
  for (const char* label : {"pose of the target in each picture: 1 of 16", "registering: 0 of ", "fitting the arm: 0 of ",
                            "searching for effects, round 1: 0 of "}) {
    EXPECT_THAT(seen, HasSubstr(std::string(kClearLine) + label));
  }
  EXPECT_THAT(seen, HasSubstr(std::string(kBold) + "diagnosis: "));
}

TEST_F(Terminal, NoLineIsLongerThanTheTerminal) {
  constexpr unsigned short kColumns = 30;
  std::string seen = test::runInTerminal(folder_.path(), kProgram + "run capture --out out 2>&1 >/dev/null", kColumns);
  std::size_t lines = 0;
  for (std::size_t at = 0; (at = seen.find(kClearLine, at)) != std::string::npos; ++lines) {
    at += std::string(kClearLine).size();
    EXPECT_LT(std::min(seen.find('\r', at), seen.size()) - at, kColumns);
  }
  EXPECT_GT(lines, 4);
}

TEST_F(Terminal, WhatIsNotATerminalGetsNeitherProgressNorColours) {
  test::runInTerminal(folder_.path(), kProgram + "run capture --out out >out.txt 2>err.txt");
  EXPECT_THAT(readTextFile(folder_.path() / "out.txt"), Not(HasSubstr(kEscape)));
  EXPECT_EQ(readTextFile(folder_.path() / "err.txt"), "");
  const std::string quiet = test::runInTerminal(folder_.path(), kProgram + "run capture --out quiet --quiet");
  EXPECT_EQ(quiet, "");
}

TEST_F(Terminal, ColoursCanBeTurnedOff) {
  const std::string wrong = kProgram + "measure nowhere --out out";
  EXPECT_THAT(test::runInTerminal(folder_.path(), wrong), StartsWith("poecal: " + std::string(kRed) + "error:"));
  EXPECT_THAT(test::runInTerminal(folder_.path(), "NO_COLOR=1 " + wrong), StartsWith("poecal: error:"));
  EXPECT_THAT(test::runInTerminal(folder_.path(), kProgram + "run capture --out out", 120, "dumb"), Not(HasSubstr(kEscape)));
}

}  // namespace
}  // namespace poecal
