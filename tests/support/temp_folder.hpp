// A folder that lives as long as its test.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "poecal/core/text.hpp"

namespace poecal::test {

class TempFolder {
 public:
  TempFolder() {
    const ::testing::TestInfo* info = ::testing::UnitTest::GetInstance()->current_test_info();
    static int count = 0;
    std::string name = std::string(info->test_suite_name()) + "." + info->name();
    for (char& c : name) {
      if (c == '/') c = '_';
    }
    path_ = std::filesystem::temp_directory_path() / ("poecal-" + std::to_string(::getpid()) + "-" + name + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code status;
    std::filesystem::remove_all(path_, status);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file of the folder and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    writeTextFile(path_ / name, content);
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Folder of the optional real captures: $POECAL_REAL_DIR, or ../shared/real beside the project.
inline std::filesystem::path realFolder() {
  const char* given = std::getenv("POECAL_REAL_DIR");
  return given != nullptr ? std::filesystem::path(given) : std::filesystem::path(POECAL_TEST_REAL_DIR);
}

}  // namespace poecal::test

/// Skips a test, saying so, where a set of the real captures is not there.
#define POECAL_REQUIRE_REAL(set)                                                                                                           \
  if (!std::filesystem::exists(poecal::test::realFolder() / (set))) {                                                                      \
    GTEST_SKIP() << "real capture '" << (set) << "' is not in " << poecal::test::realFolder() << " (POECAL_REAL_DIR names another place)"; \
  }
