// A simulation that stopped half way, killed or on a full disk, is finished by the next one to the same bytes.
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/simulation/simulate.hpp"
#include "simulation/scene_files.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

constexpr const char* kPictures = "samples: {count: 4}\nintrinsics: {target: board.yaml, count: 2}\n";

/// As long as it lives no file grows beyond so many bytes: writing fails there, as it does on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

using Content = std::map<std::string, std::string>;

/// Capture and truth.
Content contentOf(const fs::path& capture) {
  Content content;
  for (const std::string suffix : {"", "-truth"}) {
    const fs::path folder = capture.string() + suffix;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) content[suffix + "/" + fs::relative(entry.path(), folder).string()] = readTextFile(entry.path());
    }
  }
  return content;
}

TEST(ResumeSimulation, WhereverItStoppedTheNextOneFinishesIt) {
  const test::TempFolder folder;
  const Scene scene = test::smallScene(folder, kPictures);
  simulate(scene, folder.path() / "whole", {.jobs = 2});
  const Content whole = contentOf(folder.path() / "whole");
  std::set<rlim_t> sizes{1, 20};
  for (const auto& [name, content] : whole) sizes.insert(content.size() - 1);
  for (const rlim_t size : sizes) {
    const fs::path out = folder.path() / ("out-" + std::to_string(size));
    {
      const FileSizeLimit limit(size);
      EXPECT_THROW(simulate(scene, out, {.jobs = 2}), FileError) << size;
    }
    EXPECT_FALSE(fs::exists(out / "capture.yaml") && size < whole.at("/capture.yaml").size()) << "it comes last";
    simulate(scene, out, {.jobs = 1});
    EXPECT_EQ(contentOf(out), whole) << size;
  }
}

TEST(ResumeSimulation, WhatAKilledProgramLeavesOfAFileDoesNotStay) {
  const test::TempFolder folder;
  const Scene scene = test::smallScene(folder, kPictures);
  simulate(scene, folder.path() / "whole", {.jobs = 2});
  folder.write("out/.unfinished.part", "ab");
  simulate(scene, folder.path() / "out", {.jobs = 2});
  EXPECT_EQ(contentOf(folder.path() / "out"), contentOf(folder.path() / "whole"));
}

TEST(ResumeSimulation, AnotherSceneAndOtherFilesAreLeftAlone) {
  const test::TempFolder folder;
  {
    const FileSizeLimit limit(5000);
    EXPECT_THROW(simulate(test::smallScene(folder, kPictures), folder.path() / "out", {.jobs = 2}), FileError);
  }
  const Content before = contentOf(folder.path() / "out");
  EXPECT_THAT(
      [&] {
        simulate(test::smallScene(folder, std::string(kPictures) + "errors: {seed: 2, position: 1.0e-3, rotation: 0}\n"),
                 folder.path() / "out", {.jobs = 1});
      },
      Throws<FileError>(Property(&FileError::what, HasSubstr("out: holds what is unfinished of another scene"))));
  EXPECT_EQ(contentOf(folder.path() / "out"), before);

  folder.write("mine/notes.txt", "kept");
  EXPECT_THAT([&] { simulate(test::smallScene(folder, kPictures), folder.path() / "mine", {.jobs = 1}); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("mine: is there already and not empty"))));
}

}  // namespace
}  // namespace poecal
