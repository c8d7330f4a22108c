// calib_data/FORMATS.md says what the readers read and what the program writes.
#include <algorithm>
#include <cctype>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "apps/small_cell.hpp"
#include "docs/keys.hpp"
#include "docs/page.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/cell/known_registration.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/robot/arm.hpp"
#include "poecal/robot/robot_file.hpp"
#include "poecal/simulation/scene.hpp"
#include "support/matchers.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

using ::testing::IsEmpty;
using ::testing::SizeIs;

const Page& formats() {
  static const Page page = readPage(fs::path(POECAL_SOURCE_DIR) / "calib_data/FORMATS.md");
  return page;
}

/// Words that explain keys under a heading: its own, and those of the sections whose files it names.
std::set<std::string> explainedUnder(const std::string& heading) {
  const Section& own = formats().section(heading);
  std::set<std::string> words = own.words;
  for (const Section& other : formats().sections) {
    const bool named = !other.heading.empty() && own.text.find(other.heading) != std::string::npos;
    if (named) words.insert(other.words.begin(), other.words.end());
  }
  return words;
}

/// "q3" is explained by "q1", "cov23" by "cov11".
bool explains(const std::set<std::string>& words, std::string key) {
  for (char& c : key) {
    if (words.contains(key)) return true;
    if (std::isdigit(static_cast<unsigned char>(c))) c = '1';
  }
  return words.contains(key);
}

std::vector<std::string> unexplained(const std::set<std::string>& keys, const std::string& heading) {
  const std::set<std::string> words = explainedUnder(heading);
  std::vector<std::string> missing;
  for (const std::string& key : keys) {
    if (!explains(words, lastPart(key))) missing.push_back(heading + ": " + key);
  }
  return missing;
}

class Formats : public ::testing::Test {
 protected:
  Formats() {
    for (const Example& example : formats().examples) folder_.write("page/" + example.name, example.text);
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  fs::path onPage(const std::string& name) const { return path("page/" + name); }
  void runWell(const std::string& arguments) const {
    const ProgramRun result = runProgram(folder_.path(), arguments);
    ASSERT_EQ(result.status, 0) << arguments << "\n" << result.err;
  }

  TempFolder folder_;
};

TEST_F(Formats, EverySectionHasAnExample) {
  for (const Section& section : formats().sections) {
    if (section.heading.empty()) continue;
    const bool any = std::any_of(formats().examples.begin(), formats().examples.end(),
                                 [&](const Example& example) { return example.section == section.heading; });
    EXPECT_TRUE(any) << section.heading;
  }
}

TEST_F(Formats, EveryKeyOfTheExamplesIsExplained) {
  for (const Example& example : formats().examples) {
    EXPECT_THAT(unexplained(keysOf(onPage(example.name)), example.section), IsEmpty()) << example.name;
  }
}

TEST_F(Formats, TheCaptureIsRead) {
  const Capture capture = readCapture(path("page"));
  EXPECT_EQ(capture.table.samples.size(), 3u);
  EXPECT_THAT(capture.table.other_columns, ::testing::ElementsAre("coolant_flow"));
  EXPECT_TRUE(capture.arm && capture.camera && capture.reference);
  EXPECT_EQ(readDetections(capture.detections_file, capture.target, &*capture.reference).images.at(0).corners.size(), 5u);
  for (const Sample& sample : capture.table.samples) {
    EXPECT_THAT(*sample.T_base_flange, PoseIsNear(forwardKinematics(*capture.arm, sample.q), 1e-8)) << sample.image;
  }
}

TEST_F(Formats, TheTablesOfPosesAndJointsAreRead) {
  const Arm arm = readRobotYaml(onPage("robot.yaml"));
  const PoseTable table = readPoses(onPage("poses.csv"), arm);
  ASSERT_THAT(table.poses, SizeIs(3));
  EXPECT_TRUE(table.poses[0].sigma_position && table.poses[0].sigma_rotation && !table.position_only);
  EXPECT_THAT(readJoints(onPage("joints.csv"), arm), SizeIs(2));
  EXPECT_THAT(readSamples(onPage("next.csv"), arm.jointCount(), &arm).samples, SizeIs(2));
  EXPECT_THAT(readWantedPoses(onPage("wanted.csv"), arm).samples, SizeIs(2));
}

TEST_F(Formats, TheTargetsAreRead) {
  std::set<TargetType> types;
  for (const Example& example : formats().examples) {
    if (example.section == "target.yaml") types.insert(readTarget(onPage(example.name)).type);
  }
  EXPECT_THAT(types, SizeIs(5));
}

TEST_F(Formats, WhatIsKnownOfTheTransformsIsRead) {
  Registration known, found;
  readKnownRegistration(onPage("known.yaml"), known);
  EXPECT_TRUE(known.known_near && known.known_far);
  readKnownRegistration(onPage("registration.yaml"), found);
  EXPECT_TRUE(found.known_near && found.known_far);
}

TEST_F(Formats, TheScenesAreRead) {
  EXPECT_EQ(readScene(onPage("scene.yaml")).effects.size(), 1u);
  const Scene pictures = readScene(onPage("scene-pictures.yaml"));
  EXPECT_EQ(pictures.looks.size(), 2u);
  EXPECT_TRUE(pictures.board);
}

TEST_F(Formats, TheModelIsRead) {
  const Model model = readModel(onPage("model.yaml"));
  EXPECT_FALSE(model.effects.empty());
  EXPECT_TRUE(model.target && model.cell.camera);
  EXPECT_THAT(readPoses(onPage("flange_poses.csv"), *model.cell.arm).poses, SizeIs(::testing::Ge(2u)));
}

TEST_F(Formats, TheTableOfEffectsIsTheCatalogue) {
  std::string table;
  for (const EffectKind& kind : effectKinds()) {
    std::vector<std::string> drivers, parameters;
    for (const std::string& driver : kind.drivers) drivers.push_back("`" + driver + "`");
    for (const EffectParameter& parameter : kind.parameters) {
      parameters.push_back("`" + parameter.name + "`" + (parameter.unit.empty() ? "" : " [" + parameter.unit + "]"));
    }
    table +=
        fmt::format("| `{}` | `{}` | {} | {} |\n", kind.name, kind.placePattern(), fmt::join(drivers, ", "), fmt::join(parameters, ", "));
  }
  EXPECT_THAT(formats().section("model.yaml").text, ::testing::HasSubstr("|---|---|---|---|\n" + table + "\n"));
}

/// Compares what a run wrote with the page: what it wrote is explained, and what the example shows was written.
class WrittenKeys {
 public:
  void add(const fs::path& file, const std::string& example) {
    std::set<std::string> keys = keysOf(file);
    // A report holds these two files whole; their own sections explain them.
    if (example == "report.json") {
      std::erase_if(keys, [](const std::string& key) { return key.starts_with("identification.") || key.starts_with("diagnosis."); });
      keys.insert({"identification.format", "diagnosis.format"});
    }
    EXPECT_THAT(unexplained(keys, formats().example(example).section), IsEmpty()) << file;
    written_[example].insert(keys.begin(), keys.end());
  }
  void expectAllOfTheExamples(const fs::path& page) const {
    for (const auto& [example, keys] : written_) {
      for (const std::string& key : keysOf(page / example)) EXPECT_TRUE(keys.contains(key)) << example << ": nothing wrote " << key;
    }
  }

 private:
  std::map<std::string, std::set<std::string>> written_;
};

TEST_F(Formats, WhatIsWrittenOfACaptureIsWhatThePageShows) {
  writeSmallScene(folder_.path(), SmallCell::kCorners,
                  "effects: [{effect: joint_coupling, location: joint:6, parameters: {ratio: 4.0e-3, source: 5}}]\n", 40);
  runWell("simulate scene/scene.yaml --out capture");
  rewriteCsv(path("capture/detections.csv"), [](Rows& rows) {  // a picture that belongs to no model
    for (std::size_t row = 1; row <= 4; ++row) rows[row][3] = std::to_string(std::stod(rows[row][3]) + 30.0);
  });
  runWell("identify capture --out identified");
  runWell("run capture --out results");
  runWell("identify capture --method gao --out gao");
  runWell("fleet results --out fleet.csv");
  runWell("plan capture --model results/model.yaml --count 5 --candidates 100 --out next.csv");
  WrittenKeys written;
  for (const char* name : {"registration.yaml", "flange_poses.csv", "model.yaml", "identification.json", "diagnosis.json", "report.json"}) {
    written.add(path("results") / name, name);
  }
  written.add(path("gao/identification.json"), "identification.json");
  written.add(path("fleet.csv"), "fleet.csv");
  written.add(path("capture-truth/truth.yaml"), "truth.yaml");
  runWell("compensate --model results/model.yaml --joints capture/samples.csv --robot capture/cobot6.urdf --leave-out --out commands.csv");
  written.add(path("commands.csv"), "commands.csv");
  runWell(
      "export results/model.yaml --urdf capture/cobot6.urdf --transforms tf.yaml --dh dh.yaml --joint-table table.csv --camera-info "
      "ci.yaml");
  written.add(path("tf.yaml"), "transforms.yaml");
  written.add(path("dh.yaml"), "dh.yaml");
  written.add(path("table.csv"), "joint-table.csv");
  written.expectAllOfTheExamples(path("page"));
  WrittenKeys explained;
  explained.add(path("capture/samples.csv"), "samples.csv");
  explained.add(path("next.csv"), "next.csv");
  explained.add(path("ci.yaml"), "camera.yaml");
}

TEST_F(Formats, WhatIsWrittenOfPicturesIsWhatThePageShows) {
  writeSmallScene(folder_.path(), SmallCell::kPictures, "intrinsics: {target: board.yaml, count: 8}\n");
  runWell("simulate scene/scene.yaml --out capture");
  runWell("run capture --out results");
  WrittenKeys written;
  for (const char* name : {"camera.yaml", "camera-residuals.csv", "detections.csv", "detections-pictures.csv"}) {
    written.add(path("results") / name, name);
  }
  written.expectAllOfTheExamples(path("page"));
  WrittenKeys explained;
  explained.add(path("results/diagnosis.json"), "diagnosis.json");
  explained.add(path("results/report.json"), "report.json");
  explained.add(path("results/identification.json"), "identification.json");
  explained.add(path("capture/capture.yaml"), "capture.yaml");
}

TEST_F(Formats, WhatIsWrittenOfPosesIsExplained) {
  writeSmallScene(folder_.path(), SmallCell::kCorners, "", 40);
  runWell("simulate scene/scene.yaml --out capture");
  runWell("measure capture --out measured");
  const std::string source =
      "--robot capture/cobot6.urdf --base-link base_link --tip-link flange --poses measured/flange_poses.csv --registered";
  runWell("identify " + source + " --out identified");
  runWell("diagnose " + source + " --out diagnosed");
  WrittenKeys explained;
  explained.add(path("identified/identification.json"), "identification.json");
  explained.add(path("identified/model.yaml"), "model.yaml");
  explained.add(path("diagnosed/diagnosis.json"), "diagnosis.json");
  explained.add(path("diagnosed/report.json"), "report.json");
  runWell("predict capture --model diagnosed/model.yaml --poses --out predicted.csv");
  explained.add(path("predicted.csv"), "poses.csv");
}

}  // namespace
}  // namespace poecal::test
