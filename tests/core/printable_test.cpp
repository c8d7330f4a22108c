#include "poecal/core/printable.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace poecal {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Le;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST(Printable, PlainTextIsLeftAlone) {
  EXPECT_EQ(printableLine(""), "");
  EXPECT_EQ(printableLine("cell-3: 0.2 px, 100 %"), "cell-3: 0.2 px, 100 %");
  EXPECT_EQ(printableLine("Schw\u00e4nker \u2014 \u65e5\u672c \U0001F916"), "Schw\u00e4nker \u2014 \u65e5\u672c \U0001F916");
  EXPECT_EQ(printableText("one\n  two\n"), "one\n  two\n");
  EXPECT_EQ(printableText("\n\nx"), "\n\nx");
}

TEST(Printable, WhatATerminalObeysIsEscaped) {
  EXPECT_EQ(printableLine("\x1b[31mRED"), "\\x1b[31mRED");
  EXPECT_EQ(printableLine("\x1b]0;title\x07"), "\\x1b]0;title\\x07");
  EXPECT_EQ(printableLine("a\nb\tc\rd\x7f"), "a\\nb\\tc\\x0dd\\x7f");
  EXPECT_EQ(printableLine(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printableLine("\u009b31m"), "\\u009b31m") << "C1: one sign that begins a sequence";
  EXPECT_EQ(printableLine("\u202eabc\u2066d\u200b\ufeff"), "\\u202eabc\\u2066d\\u200b\\ufeff") << "turned and unseen";
}

TEST(Printable, WhatIsNotUtf8IsEscapedByteByByte) {
  EXPECT_EQ(printableLine("Schw\xe4nker"), "Schw\\xe4nker");
  EXPECT_EQ(printableLine("\xc0\xaf"), "\\xc0\\xaf") << "longer than need be";
  EXPECT_EQ(printableLine("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a pair";
  EXPECT_EQ(printableLine("cut \xe2\x82"), "cut \\xe2\\x82");
}

TEST(Printable, EveryByteAndPairOfBytesBecomesPrintable) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string text{static_cast<char>(first), static_cast<char>(second)};
      const std::string line = printableLine(text);
      EXPECT_EQ(printableLine(line), line) << first << " " << second << ": printable once and for all";
      for (const char c : line) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) << first << " " << second;
    }
  }
}

TEST(Printable, LongLinesLoseTheirMiddle) {
  const std::string name(2'000'000, 'n');
  const std::string line = printableLine("robot.yaml:3: '" + name + "' is not known, expected another", 100);
  EXPECT_THAT(line, SizeIs(Le(100u)));
  EXPECT_THAT(line, StartsWith("robot.yaml:3: 'nnn"));
  EXPECT_THAT(line, EndsWith(" is not known, expected another"));
  EXPECT_THAT(line, HasSubstr("n ... "));
  EXPECT_THAT(printableLine(std::string(1000, '\x1b'), 100), SizeIs(Le(100u))) << "what counts is what is printed";
  std::string signs;
  for (int k = 0; k < 100; ++k) signs += "\u00e4";
  for (std::size_t longest = 20; longest < 60; ++longest) {
    EXPECT_THAT(printableLine(signs, longest), Not(HasSubstr("\\x"))) << "no sign is cut in two, " << longest;
  }
  EXPECT_EQ(printableText(std::string(5000, 'x') + "\nend\n").substr(kLongestPrintedLine), "\nend\n");
}

TEST(AsciiJson, IsWhatAWriterOfAsciiWrites) {
  nlohmann::ordered_json json;
  json["Schw\u00e4nker"] = {0.1, 1e300, -0.0, 7, true, nullptr, nlohmann::json::object(), nlohmann::json::array()};
  json["signs"] = std::string("\0\x1f \"\\/\x7f", 8) + "\u0080\u009b\u202e\ufeff\uffff\U00010000\U0001F916\U0010FFFF";
  for (const int indent : {-1, 2}) {
    EXPECT_EQ(asciiJson(json.dump(indent)), json.dump(indent, ' ', true));
  }
  EXPECT_EQ(asciiJson(""), "");
  EXPECT_EQ(asciiJson("{\"a\": 1}\n"), "{\"a\": 1}\n");
}

TEST(AsciiJson, OfEverySignIsThatSign) {
  for (std::uint32_t code = 0x7f; code < 0x11000; code += code < 0x300 ? 1 : 97) {
    if (code >= 0xD800 && code < 0xE000) continue;
    const std::string escape =
        code < 0x10000 ? fmt::format("\\u{:04x}", code) : fmt::format("\\u{:04x}\\u{:04x}", 0xD7C0 + (code >> 10), 0xDC00 + (code & 0x3FF));
    const auto sign = nlohmann::json::parse("\"" + escape + "\"").get<std::string>();
    EXPECT_EQ(asciiJson("\"a" + sign + "b\""), "\"a" + escape + "b\"") << code;
  }
}

TEST(AsciiJson, WhatIsNotUtf8IsReplacedByteByByte) {
  EXPECT_EQ(asciiJson("\"Schw\xe4nker\""), "\"Schw\\ufffdnker\"");
  EXPECT_EQ(asciiJson("\"\xc0\xaf\""), "\"\\ufffd\\ufffd\"");
}

}  // namespace
}  // namespace poecal
