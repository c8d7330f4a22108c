// The main job from measurements in memory.
#include "poecal/calibration/calibrate.hpp"

#include <gmock/gmock.h>

#include "calibration/identified_folder.hpp"
#include "diagnosis/small_cell.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

constexpr double kSigma = 0.1;  // [px]

Cell nominalOf(const test::SmallCell& small) { return {.arm = small.nominal, .camera = small.cell.camera, .registration = {}}; }

/// What a program that has its own detector hands over, picture by picture.
Measurements handedOver(const test::SmallCell& small) {
  Measurements measurements;
  measurements.target = small.target;
  for (std::size_t k = 0; k < small.samples.size(); ++k) {
    std::vector<Corner> corners;
    for (const CornerMeasurement& corner : small.observations[k].corners) corners.push_back({.id = corner.id, .px = corner.px});
    measurements.addPicture(small.samples[k], corners);
  }
  return measurements;
}

TEST(Calibrate, FindsFromMemoryWhatIsWrong) {
  const test::SmallCell small =
      test::smallCell(11, 60, kSigma, {{.effect = "joint_backlash", .location = "joint:2", .parameters = {{"half_gap", 4e-4}}}});
  const Measurements measurements = handedOver(small);
  EXPECT_FALSE(measurements.sigmas_stated);
  const Calibration calibration = calibrate(nominalOf(small), measurements);
  ASSERT_TRUE(calibration.registration && calibration.identification && calibration.diagnosis);
  ASSERT_FALSE(calibration.diagnosis->findings.empty());
  EXPECT_EQ(calibration.diagnosis->findings.front().effect, "joint_backlash");
  EXPECT_EQ(calibration.diagnosis->findings.front().location, "joint:2");
  EXPECT_EQ(calibration.model_source, ModelSource::kDiagnosed);
  EXPECT_FALSE(calibration.model->effects.empty());
  EXPECT_TRUE(calibration.model->target.has_value());
}

TEST(Calibrate, GoesAsFarAsAsked) {
  const test::SmallCell small = test::smallCell(12, 20, kSigma, {});
  const Measurements measurements = handedOver(small);
  const Calibration registered = calibrate(nominalOf(small), measurements, {.last = CalibrationStep::kRegistration});
  EXPECT_TRUE(registered.registration && !registered.identification && !registered.model);
  const Calibration identified = calibrate(nominalOf(small), measurements, {.last = CalibrationStep::kIdentification});
  EXPECT_TRUE(identified.identification && identified.model && !identified.diagnosis);
  EXPECT_THAT(identified.no_diagnosis, IsEmpty());
}

TEST(Calibrate, SaysWhyThereIsNoDiagnosis) {
  const test::SmallCell small = test::smallCell(13, 10, kSigma, {});
  const Calibration calibration = calibrate(nominalOf(small), handedOver(small));
  EXPECT_FALSE(calibration.diagnosis);
  EXPECT_THAT(calibration.no_diagnosis, HasSubstr("10 poses are too few"));
  EXPECT_EQ(calibration.model_source, ModelSource::kIdentified);
  EXPECT_TRUE(calibration.model.has_value());
}

TEST(Calibrate, ACornerThatTheTargetDoesNotHaveIsRefused) {
  const test::SmallCell small = test::smallCell(14, 1, kSigma, {});
  Measurements measurements;
  measurements.target = small.target;
  EXPECT_THAT(
      [&] {
        measurements.addPicture(small.samples.front(), {{.id = {.tag = 9, .corner = 0}, .px = {1.0, 1.0}}});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("tag 9, corner 0 is not on the target")));
  EXPECT_THAT(measurements.samples, IsEmpty());
}

TEST(Calibrate, OptionsAreValidated) {
  EXPECT_THAT([] { calibrate({}, {}, {.jobs = -1}); }, ThrowsMessage<InvalidArgument>(HasSubstr("jobs is -1")));
}

TEST(Measurements, OneStatedDeviationOfCornersIsEnoughAndAllOfPosesAreNeeded) {
  const test::SmallCell small = test::smallCell(15, 2, kSigma, {});
  Measurements pictures;
  pictures.target = small.target;
  pictures.addPicture(small.samples[0], {{.id = small.target.points[0].id, .px = {1.0, 2.0}, .sigma = 0.2}});
  EXPECT_TRUE(pictures.sigmas_stated);
  Measurements poses;
  poses.addPose(small.samples[0], Eigen::Isometry3d::Identity(), 1e-4, 1e-3);
  EXPECT_TRUE(poses.sigmas_stated);
  poses.addPose(small.samples[1], Eigen::Isometry3d::Identity());
  EXPECT_FALSE(poses.sigmas_stated);
}

class IdentifiedFolder : public ::testing::Test {
 protected:
  void requireIdentifiedHere() { requireIdentified(folder_.path(), calibration_, measurements_); }

  test::SmallCell small_ = test::smallCell(16, 20, kSigma, {});
  Measurements measurements_ = handedOver(small_);
  Calibration calibration_ = calibrate(nominalOf(small_), measurements_, {.last = CalibrationStep::kIdentification});
  test::TempFolder folder_;
};

TEST_F(IdentifiedFolder, ItsOwnIsTaken) {
  folder_.write("model.yaml", modelYaml(*calibration_.model));
  EXPECT_NO_THROW(requireIdentifiedHere());
}

TEST_F(IdentifiedFolder, WhatIsNoModelIsRefused) {
  folder_.write("model.yaml", "garbage\n");
  EXPECT_THAT([this] { requireIdentifiedHere(); }, ThrowsMessage<FileError>(HasSubstr("model.yaml:1: ")));
}

TEST_F(IdentifiedFolder, AnotherArmOrTargetIsRefused) {
  Model other = *calibration_.model;
  other.cell.arm->joints[2].name = "elbow";
  folder_.write("model.yaml", modelYaml(other));
  EXPECT_THAT([this] { requireIdentifiedHere(); }, ThrowsMessage<FileError>(HasSubstr("its joint 3 is 'elbow', expected 'joint_3'")));
  other = *calibration_.model;
  other.target = apriltagTarget("tag36h11", {{.id = 1, .size = 0.1}});
  folder_.write("model.yaml", modelYaml(other));
  EXPECT_THAT([this] { requireIdentifiedHere(); }, ThrowsMessage<FileError>(HasSubstr("its target is not that of the capture")));
}

TEST_F(IdentifiedFolder, AModelFromPosesIsRefused) {
  Model other = *calibration_.model;
  other.cell.camera.reset();
  other.target.reset();
  folder_.write("model.yaml", modelYaml(other));
  EXPECT_THAT([this] { requireIdentifiedHere(); }, ThrowsMessage<FileError>(HasSubstr("model.yaml:1: has no camera")));
}

TEST_F(IdentifiedFolder, TheResultsOfAnotherCaptureAreRefused) {
  const test::SmallCell elsewhere = test::smallCell(17, 20, kSigma, {});  // the same kind of arm with other errors
  folder_.write("model.yaml",
                modelYaml(*calibrate(nominalOf(elsewhere), handedOver(elsewhere), {.last = CalibrationStep::kIdentification}).model));
  EXPECT_THAT([this] { requireIdentifiedHere(); }, ThrowsMessage<FileError>(HasSubstr("the results of another capture?")));
}

}  // namespace
}  // namespace poecal
