#include "poecal/core/text.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

TEST(Text, NumbersAreShortAndAlwaysLookLikeNumbers) {
  EXPECT_EQ(formatNumber(0.1), "0.1");
  EXPECT_EQ(formatNumber(3.0), "3.0");
  EXPECT_EQ(formatNumber(-0.0), "0.0");
  EXPECT_EQ(formatNumber(1e-5), "1.0e-05");
  EXPECT_EQ(formatNumber(1e300), "1.0e+300");
  EXPECT_EQ(std::stod(formatNumber(1.0 / 3.0)), 1.0 / 3.0);
  EXPECT_EQ(std::stod(formatNumber(1e-300)), 1e-300);
}

TEST(Text, WritingReplacesTheWholeFileAndLeavesNothingElse) {
  const test::TempFolder folder;
  const auto file = folder.path() / "sub" / "a.txt";
  writeTextFile(file, "first");
  writeTextFile(file, "second");
  EXPECT_EQ(readTextFile(file), "second");
  writeTextFile(file, "");
  EXPECT_EQ(readTextFile(file), "");
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path() / "sub")) ++entries;
  EXPECT_EQ(entries, 1);
  EXPECT_THROW(writeTextFile(file / "below-a-file.txt", "x"), FileError);
}

}  // namespace
}  // namespace poecal
