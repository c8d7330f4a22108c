// The files of a calibration hold what it found, and are read back as they were written.
#include "poecal/calibration/results.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "diagnosis/small_cell.hpp"
#include "poecal/calibration/fleet.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class Results : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    small_ = new test::SmallCell(
        test::smallCell(21, 40, 0.1, {{.effect = "joint_backlash", .location = "joint:3", .parameters = {{"half_gap", 6e-4}}}}));
    measurements_ = new Measurements(small_->measurements());
    for (Sample& sample : measurements_->samples) {
      sample.temperature = 20.0;
      sample.other = {0.5};
    }
    measurements_->other_columns = {"humidity"};
    calibration_ = new Calibration(calibrate({.arm = small_->nominal, .camera = small_->cell.camera, .registration = {}}, *measurements_));
  }
  static void TearDownTestSuite() {
    delete calibration_;
    delete measurements_;
    delete small_;
  }
  std::filesystem::path path(const char* name) const { return folder_.path() / name; }

  static const test::SmallCell* small_;
  static Measurements* measurements_;
  static const Calibration* calibration_;
  test::TempFolder folder_;
};

const test::SmallCell* Results::small_ = nullptr;
Measurements* Results::measurements_ = nullptr;
const Calibration* Results::calibration_ = nullptr;

TEST_F(Results, FlangePosesKeepTheColumnsOfTheSamples) {
  folder_.write("flange_poses.csv", flangePosesCsv(*calibration_, *measurements_));
  const PoseTable table = readPoses(path("flange_poses.csv"), small_->nominal);
  ASSERT_THAT(table.poses, SizeIs(40));
  EXPECT_THAT(table.other_columns, ::testing::ElementsAre("humidity"));
  const Sample &read = table.poses[7].sample, &given = measurements_->samples[7];
  EXPECT_EQ(read.q, given.q);
  EXPECT_EQ(read.stamp, given.stamp);
  EXPECT_EQ(read.dir, given.dir);
  EXPECT_EQ(read.temperature, given.temperature);
  EXPECT_EQ(read.other, given.other);
  EXPECT_TRUE(table.poses[7].sigma_position && table.poses[7].sigma_rotation);
}

TEST_F(Results, OnlyWhatIsAskedForIsWritten) {
  writeResults(*calibration_, *measurements_, {.registration = true}, path("measured"));
  EXPECT_TRUE(std::filesystem::exists(path("measured/registration.yaml")));
  EXPECT_FALSE(std::filesystem::exists(path("measured/model.yaml")));
  writeResults(*calibration_, *measurements_, {.diagnosis = true}, path("diagnosed"));
  EXPECT_TRUE(std::filesystem::exists(path("diagnosed/model.yaml")));
  EXPECT_FALSE(std::filesystem::exists(path("diagnosed/identification.json")));
}

TEST_F(Results, AreReadBackInShort) {
  writeResults(*calibration_, *measurements_, {.registration = true, .identification = true, .diagnosis = true}, path("out"));
  const ResultSummary read = readResults(path("out"));
  EXPECT_EQ(read.name, "out");
  EXPECT_EQ(read.pictures, 40);
  EXPECT_EQ(read.registration_px, calibration_->registration->rms_px);
  ASSERT_NE(read.stage("identified"), nullptr);
  EXPECT_EQ(read.stage("identified")->rms_px, calibration_->identification->stages.back().held_out.px.rms);
  EXPECT_EQ(read.stage("diagnosed"), nullptr);
  ASSERT_THAT(read.findings, SizeIs(calibration_->diagnosis->findings.size()));
  EXPECT_EQ(read.findings.front().effect, "joint_backlash");
  EXPECT_THAT(fleetRow(read), SizeIs(fleetColumns().size()));
}

TEST_F(Results, OfTwoRunsAreNotTakenForOne) {
  writeResults(*calibration_, *measurements_, {.registration = true, .identification = true, .diagnosis = true}, path("out"));
  const test::SmallCell other = test::smallCell(22, 40, 0.1, {});
  const Measurements measured = other.measurements();
  const Calibration calibration = calibrate({.arm = other.nominal, .camera = other.cell.camera, .registration = {}}, measured);
  writeTextFile(path("out/identification.json"), identificationJson(*calibration.identification, measured.samples));
  EXPECT_THAT([this] { readResults(path("out")); },
              ::testing::ThrowsMessage<FileError>(::testing::HasSubstr("in identification.json: expected results of one run")));
}

TEST_F(Results, DiagnosisSaysWhatTheModelIs) {
  const auto json = nlohmann::json::parse(diagnosisJson(*calibration_, *measurements_));
  EXPECT_EQ(json["model_source"], "diagnosed");
  EXPECT_FALSE(json["model_source_why"].get<std::string>().empty());
}

TEST_F(Results, AnEmptyFolderIsEmpty) {
  const ResultSummary read = readResults(folder_.path());
  EXPECT_FALSE(read.pictures || read.poses || read.verdict);
  EXPECT_THAT(read.stages, IsEmpty());
}

}  // namespace
}  // namespace poecal
