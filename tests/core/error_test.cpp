#include "poecal/core/error.hpp"

#include <string>

#include <gmock/gmock.h>

namespace poecal {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Le;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST(Error, OfAFileNamesItAndTheLine) {
  EXPECT_STREQ(FileError("a/b.yaml", 7, "is 'x', expected a number").what(), "a/b.yaml:7: is 'x', expected a number");
  EXPECT_STREQ(FileError("a/b.yaml", 0, "no such file").what(), "a/b.yaml: no such file");
  EXPECT_EQ(FileError("a/b.yaml", 7, "no such key").reason(), "no such key");
  EXPECT_EQ(FileError("a\x1b.yaml", 0, "no such\nfile").reason(), "no such\\nfile");
}

TEST(Error, WhatATerminalObeysIsEscaped) {
  EXPECT_STREQ(FileError("a\x1b[2J.yaml", 1, "unknown key 'b\nc'").what(), "a\\x1b[2J.yaml:1: unknown key 'b\\nc'");
  EXPECT_STREQ(InvalidArgument("no \x07").what(), "no \\x07");
  EXPECT_STREQ(InsufficientData("\u202eno rows").what(), "\\u202eno rows");
}

TEST(Error, LongTextsLeaveRoomForWhatIsExpected) {
  const std::string much(100'000, 'x');
  const FileError error(much + ".yaml", 1'000'000'000, "is '" + much + "', expected a number");
  const std::string text = error.what();
  EXPECT_THAT(text, SizeIs(Le(kLongestPrintedLine)));
  EXPECT_THAT(text, StartsWith("xxx"));
  EXPECT_THAT(text, HasSubstr(".yaml:1000000000: is 'xxx"));
  EXPECT_THAT(text, EndsWith("xxx', expected a number"));
  EXPECT_THAT(error.reason(), StartsWith("is 'xxx"));
  EXPECT_EQ(printableLine(text), text) << "the program prints it as it is";
}

}  // namespace
}  // namespace poecal
