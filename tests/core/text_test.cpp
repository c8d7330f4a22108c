#include "poecal/core/text.hpp"

#include <sys/stat.h>

#include <fstream>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/core/parallel.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

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

template <typename Call>
std::string errorOf(const Call& call) {
  try {
    call();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Text, WhatCannotBeReadSaysWhy) {
  namespace fs = std::filesystem;
  const test::TempFolder folder;
  const auto reasonOf = [](const fs::path& file) { return errorOf([&] { readTextFile(file); }); };
  fs::create_symlink("ring", folder.path() / "ring");
  fs::create_symlink("/proc/self/mem", folder.path() / "memory");
  fs::create_symlink("/dev/zero", folder.path() / "zeros");
  folder.write("file", "");
  EXPECT_THAT(reasonOf(folder.path() / "none"), EndsWith("none: no such file"));
  EXPECT_THAT(reasonOf(folder.path() / "file/below"), EndsWith("below: no such file"));
  EXPECT_THAT(reasonOf(folder.path() / "ring"), EndsWith("ring: cannot be read: Too many levels of symbolic links"));
  EXPECT_THAT(reasonOf(folder.path() / "memory"), EndsWith("memory: cannot be read: Input/output error"));
  EXPECT_THAT(reasonOf(folder.path() / "zeros"), EndsWith("zeros: is no regular file, expected one"));
  EXPECT_THAT(reasonOf(folder.path() / std::string(5000, 'x')), EndsWith(": cannot be read: File name too long"));
  EXPECT_THAT(reasonOf(folder.path()), EndsWith("is a folder, expected a file"));
  std::ofstream(folder.path() / "huge").close();
  fs::resize_file(folder.path() / "huge", (std::uintmax_t{1} << 31) + 1);  // a hole: it takes no room
  EXPECT_THAT(reasonOf(folder.path() / "huge"), EndsWith("huge: is larger than 2 GiB, expected a smaller file"));
  EXPECT_FALSE(readTextFile("/proc/self/status").empty()) << "a file without a size";
}

TEST(Text, OnlyRegularFilesAreReplaced) {
  namespace fs = std::filesystem;
  const test::TempFolder folder;
  const fs::path target = folder.write("target", "kept");
  fs::create_symlink("target", folder.path() / "link");
  fs::create_symlink("nowhere", folder.path() / "dangling");
  ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  fs::create_directory(folder.path() / "folder");
  for (const char* name : {"link", "dangling", "pipe", "folder"}) {
    const fs::file_type before = fs::symlink_status(folder.path() / name).type();
    EXPECT_THAT(errorOf([&] { writeTextFile(folder.path() / name, "x"); }), HasSubstr("is there and no regular file")) << name;
    EXPECT_EQ(fs::symlink_status(folder.path() / name).type(), before) << name;
  }
  EXPECT_EQ(readTextFile(target), "kept");
  EXPECT_FALSE(fs::exists(folder.path() / "nowhere"));
}

TEST(Text, WhatAKilledProgramLeftIsUsedAgain) {
  const test::TempFolder folder;
  folder.write("a.txt.part", "a longer text that was cut sho");
  writeTextFile(folder.path() / "a.txt", "new");
  EXPECT_EQ(readTextFile(folder.path() / "a.txt"), "new");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.txt.part"));
}

TEST(Text, TwoWritersOfOneFileLeaveOneOfTheirTexts) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder.path() / "a.txt";
  parallelFor(200, 4, [&](std::size_t k) { writeTextFile(file, std::string(10'000 + k, static_cast<char>('a' + k % 26))); });
  const std::string text = readTextFile(file);
  EXPECT_EQ(text, std::string(text.size(), text.front()));
  EXPECT_EQ(text.front(), static_cast<char>('a' + (text.size() - 10'000) % 26));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.txt.part"));
}

}  // namespace
}  // namespace poecal
