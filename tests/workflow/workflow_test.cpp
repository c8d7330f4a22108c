// apps/workflow by snakemake's local executor: a fleet's files are those of `poecal run`, and what is up to date is not done again.
#include <gmock/gmock.h>

#include "apps/small_cell.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/robot/arm.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

constexpr const char* kWorkflow = POECAL_SOURCE_DIR "/apps/workflow";

/// Files of a result folder that a user sees.
std::map<std::string, std::string> visible(const fs::path& folder) {
  std::map<std::string, std::string> content = test::contentOf(folder);
  // A report is made by `run` or by hand, and names its capture's folder from where it is itself.
  std::erase_if(content, [](const auto& file) { return file.first.starts_with('.') || file.first.starts_with("report."); });
  return content;
}

/// The capture without joints, as a controller that only knows flange poses would have left it.
void replaceJointsByPoses(const fs::path& folder) {
  Capture capture = readCapture(folder);
  SampleTable& table = capture.table;
  table.has_joints = false;
  table.has_flange_poses = true;
  for (Sample& sample : table.samples) {
    sample.T_base_flange = forwardKinematics(*capture.arm, sample.q);
    sample.q.resize(0);
    sample.dir.resize(0);
  }
  writeTextFile(folder / "samples.csv", samplesCsv(table));
}

class Workflow : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::runShell(folder_.path(), "command -v snakemake").status != 0) {
      GTEST_SKIP() << "snakemake is not installed (apps/install-dependencies.sh --workflow)";
    }
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  test::ProgramRun run(const std::string& arguments) const {
    test::ProgramRun result = test::runProgram(folder_.path(), arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result;
  }
  /// Simulates a small cell into captures/NAME.
  void simulate(const std::string& name, test::SmallCell kind, int poses, const std::string& more = "") const {
    test::writeSmallScene(folder_.path(), kind, more, poses);
    run("simulate scene/scene.yaml --out 'captures/" + name + "'");
  }
  void configure(const std::vector<std::string>& names) const {
    std::string text = "results: results\npictures_per_part: 5\npoecal: \"" POECAL_PROGRAM "\"\ncaptures:\n";
    for (const std::string& name : names) text += "  " + name + ": captures/" + name + "\n";
    folder_.write("fleet.yaml", text);
  }
  test::ProgramRun snakemake(const std::string& options) const {
    // Its cache goes where the test goes.
    return test::runShell(folder_.path(), "XDG_CACHE_HOME=\"$PWD/cache\" snakemake --snakefile '" + std::string(kWorkflow) +
                                              "/Snakefile' --configfile fleet.yaml " + options);
  }
  /// By the profile for one machine; what it said.
  std::string snakemakeWell() const {
    const test::ProgramRun result = snakemake("--profile '" + std::string(kWorkflow) + "/profiles/local' --cores 2");
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out + result.err;
  }

  test::TempFolder folder_;
};

TEST_F(Workflow, LeavesTheFilesThatRunLeaves) {
  simulate("with lens", test::SmallCell::kPictures, 12, "intrinsics: {target: board.yaml, count: 6}\n");
  simulate("few", test::SmallCell::kPictures, 8);
  simulate("corners", test::SmallCell::kCorners, 40,
           "effects: [{effect: joint_coupling, location: joint:6, parameters: {ratio: 4.0e-3, source: 5}}]\n");
  simulate("poses", test::SmallCell::kCorners, 12);
  replaceJointsByPoses(path("captures/poses"));
  const std::vector<std::string> names{"with lens", "few", "corners", "poses"};
  configure(names);
  snakemakeWell();

  fs::create_directories(path("alone"));
  std::string folders;
  for (const std::string& name : names) {
    run("run 'captures/" + name + "' --out 'alone/results/" + name + "'");
    EXPECT_EQ(visible(path("results/" + name)), visible(path("alone/results/" + name))) << name;
    folders += " 'results/" + name + "'";
  }
  EXPECT_TRUE(fs::exists(path("results/corners/diagnosis.json")));
  EXPECT_FALSE(fs::exists(path("results/poses/model.yaml"))) << "without joints there is registration alone";
  ASSERT_EQ(test::runProgram(path("alone"), "fleet" + folders + " --out results/fleet.csv").status, 0);
  EXPECT_EQ(readTextFile(path("results/fleet.csv")), readTextFile(path("alone/results/fleet.csv")));
}

TEST_F(Workflow, SearchesOnlyThePartWhosePictureChanged) {
  simulate("cell", test::SmallCell::kPictures, 11);
  configure({"cell"});
  snakemakeWell();
  EXPECT_THAT(snakemakeWell(), HasSubstr("Nothing to be done"));
  const auto part = [this](int k) { return path("results/cell/.workflow/" + std::to_string(k) + "-of-3.corners"); };
  const auto first = fs::last_write_time(part(1)), second = fs::last_write_time(part(2));
  const std::string third = readTextFile(part(3));
  // Parts begin with pictures 0, 3 and 7. Workflow and program must agree on that for the third part's content to change.
  const fs::path picture = path("captures/cell/images/0007.png");
  writeTextFile(picture, readTextFile(picture) + "padding");
  snakemakeWell();
  EXPECT_EQ(fs::last_write_time(part(1)), first);
  EXPECT_EQ(fs::last_write_time(part(2)), second);
  EXPECT_NE(readTextFile(part(3)), third);
}

TEST_F(Workflow, TablesTheOthersWhereOneCaptureFails) {
  simulate("good", test::SmallCell::kPictures, 8);
  simulate("bad", test::SmallCell::kPictures, 8);
  configure({"bad", "good"});
  const fs::path target = path("captures/bad/target.yaml");
  const std::string right = readTextFile(target);
  writeTextFile(target, "type: none\n");
  const std::string local = "--profile '" + std::string(kWorkflow) + "/profiles/local' --cores 2";
  EXPECT_NE(snakemake(local).status, 0);
  EXPECT_TRUE(fs::exists(path("results/good/registration.yaml")));
  ASSERT_TRUE(fs::exists(path("results/fleet.csv")));
  EXPECT_THAT(readTextFile(path("results/fleet.csv")), HasSubstr("good"));
  writeTextFile(target, right);
  snakemakeWell();
  const std::string both = readTextFile(path("results/fleet.csv"));
  run("fleet results/bad results/good --out again.csv");
  EXPECT_EQ(both, readTextFile(path("again.csv")));
  EXPECT_TRUE(fs::exists(path("results/bad/registration.yaml")));
}

TEST_F(Workflow, SaysWhatTheConfigurationLacks) {
  folder_.write("fleet.yaml", "results: results\n");
  const test::ProgramRun result = snakemake("--cores 1");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.err, HasSubstr("the configuration has no captures"));
}

}  // namespace
}  // namespace poecal
