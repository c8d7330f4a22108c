// A result never takes the place of an input, nor of what is no file.
#include <sys/stat.h>

#include <gmock/gmock.h>

#include "apps/small_cell.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::Not;

/// A capture with few pictures and a model of it.
class Outputs : public ::testing::Test {
 protected:
  Outputs() { test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures, 4); }

  fs::path path(const std::string& name) const { return folder_.path() / name; }

  /// Runs `command --out OUT` for the input itself and every other name that it can have.
  void expectRefused(const std::string& command, const std::string& input) const {
    fs::create_symlink(path(input), path("symbolic"));
    fs::create_hard_link(path(input), path("hard"));
    const std::string roundabout = "./capture/../" + input;
    for (const std::string& out : {input, path(input).string(), roundabout, std::string("symbolic"), std::string("hard")}) {
      const auto before = test::contentOf(folder_.path());
      const test::ProgramRun run = test::runProgram(folder_.path(), command + " --out '" + out + "'");
      EXPECT_EQ(run.status, 2) << command << " " << out << "\n" << run.err;
      EXPECT_THAT(run.err, HasSubstr("is an input itself, expected another place for the result")) << command << " " << out;
      auto after = test::contentOf(folder_.path());
      for (const char* stream : {"stdout.txt", "stderr.txt"}) after.erase(stream);
      for (const auto& [name, content] : after) EXPECT_EQ(content, before.at(name)) << command << " " << out << ": " << name;
    }
    fs::remove(path("symbolic"));
    fs::remove(path("hard"));
  }

  test::TempFolder folder_;
};

TEST_F(Outputs, OfDetectAreNoInput) {
  for (const char* input : {"capture.yaml", "samples.csv", "target.yaml", "camera.yaml", "cobot6.urdf", "images/0001.png"}) {
    expectRefused("detect capture", std::string("capture/") + input);
  }
  expectRefused("detect capture --part 1/2", "capture/samples.csv");
  fs::copy_file(path("capture/camera.yaml"), path("other.yaml"));
  expectRefused("detect capture --intrinsics other.yaml", "other.yaml");
}

TEST_F(Outputs, OfDetectBesideItAreNoInputEither) {
  fs::copy_file(path("capture/samples.csv"), path("capture/a-pictures.csv"));
  test::replaceInFile(path("capture/capture.yaml"), "samples.csv", "a-pictures.csv");
  const test::ProgramRun run = test::runProgram(folder_.path(), "detect capture --out capture/a.csv");
  EXPECT_EQ(run.status, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr("a-pictures.csv is an input itself"));
}

TEST_F(Outputs, OfIntrinsicsAreNoInput) {
  fs::create_directory(path("board"));
  fs::copy_file(path("capture/target.yaml"), path("board/target.yaml"));
  fs::copy_file(path("capture/images/0001.png"), path("board/a.png"));
  expectRefused("intrinsics board", "board/target.yaml");
  expectRefused("intrinsics board", "board/a.png");
}

TEST_F(Outputs, OfOneCommandMayTakeThePlaceOfThoseBefore) {
  for (int time = 0; time < 2; ++time) {
    EXPECT_EQ(test::runProgram(folder_.path(), "detect capture --out capture/detections.csv").status, 0) << time;
  }
}

TEST_F(Outputs, OnlyTakeThePlaceOfFiles) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  fs::create_symlink("nowhere", path("dangling"));
  fs::create_symlink("/dev/null", path("device"));
  fs::create_directory(path("folder"));
  for (const char* out : {"pipe", "dangling", "folder", "device"}) {
    const test::ProgramRun run = test::runProgram(folder_.path(), std::string("detect capture --out ") + out);
    EXPECT_EQ(run.status, 3) << out;
    EXPECT_THAT(run.err, HasSubstr("is there and no regular file, expected a new name or a file to replace")) << out;
  }
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  EXPECT_FALSE(fs::exists(path("nowhere")));
  EXPECT_TRUE(fs::is_empty(path("folder")));
}

TEST(OutputsOfAFit, AreNoInput) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kCorners);
  const auto path = [&](const std::string& name) { return folder.path() / name; };
  ASSERT_EQ(test::runProgram(folder.path(), "identify capture --out out").status, 0);
  const std::string model = readTextFile(path("out/model.yaml")), samples = readTextFile(path("capture/samples.csv"));

  for (const std::string out : {"out/model.yaml", "capture/samples.csv", "capture/detections.csv", "./capture/../out/model.yaml"}) {
    const test::ProgramRun run = test::runProgram(folder.path(), "predict capture --model out/model.yaml --out " + out);
    EXPECT_EQ(run.status, 2) << out;
    EXPECT_THAT(run.err, HasSubstr("is an input itself")) << out;
  }
  // Into the capture's own folder, where a result has the name of an input.
  fs::rename(path("capture/samples.csv"), path("capture/flange_poses.csv"));
  test::replaceInFile(path("capture/capture.yaml"), "samples.csv", "flange_poses.csv");
  for (const char* command : {"measure", "identify", "diagnose", "run"}) {
    const test::ProgramRun run = test::runProgram(folder.path(), std::string(command) + " capture --out capture");
    EXPECT_EQ(run.status, 2) << command;
    EXPECT_THAT(run.err, HasSubstr("flange_poses.csv is an input itself")) << command;
  }
  EXPECT_EQ(readTextFile(path("capture/flange_poses.csv")), samples);
  EXPECT_EQ(readTextFile(path("out/model.yaml")), model);
  EXPECT_EQ(test::runProgram(folder.path(), "fleet out --out out/registration.yaml").status, 0) << "that is not there: no input";
  EXPECT_EQ(test::runProgram(folder.path(), "fleet out --out out/identification.json").status, 2);
}

}  // namespace
}  // namespace poecal
