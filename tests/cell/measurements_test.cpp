// Rows of arrays are the same measurements as one call for each.
#include "poecal/cell/measurements.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "poecal/capture/sample_arrays.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();

SampleTable threeRows() {
  return sampleTable({.q = (Eigen::MatrixXd(3, 1) << 0.1, 0.2, 0.3).finished(), .other = {{"humidity", Eigen::Vector3d(1.0, 2.0, 3.0)}}});
}

Measurements ofOneTag() {
  Measurements measurements;
  measurements.target = apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}});
  return measurements;
}

std::vector<Eigen::MatrixX2d> threePictures() {
  std::vector<Eigen::MatrixX2d> px(3, (Eigen::MatrixX2d(4, 2) << 1, 2, 3, 4, 5, 6, 7, 8).finished());
  px[1].row(2).setConstant(kUnseen);
  px[2].setConstant(kUnseen);
  return px;
}

TEST(Measurements, PicturesAreAddedRowByRow) {
  Measurements measurements = ofOneTag();
  measurements.addPictures(threeRows(), threePictures(), 0.2);
  EXPECT_THAT(measurements.samples, SizeIs(3));
  EXPECT_THAT(measurements.other_columns, ElementsAre("humidity"));
  EXPECT_TRUE(measurements.sigmas_stated);
  ASSERT_THAT(measurements.observations, SizeIs(2));  // the third picture shows nothing
  const Observation& second = measurements.observations[1];
  EXPECT_EQ(second.sample, 1u);
  EXPECT_EQ(second.q(0), 0.2);
  ASSERT_THAT(second.corners, SizeIs(3));
  EXPECT_EQ(second.corners[2].id, (PointId{7, 3}));
  EXPECT_EQ(second.corners[2].px, Eigen::Vector2d(7.0, 8.0));
  EXPECT_EQ(second.corners[2].sigma_px, 0.2);
}

TEST(Measurements, PicturesThatDoNotFitAreRefusedAndNoneIsAdded) {
  Measurements measurements = ofOneTag();
  const auto refuses = [&](const std::vector<Eigen::MatrixX2d>& px, const char* words) {
    EXPECT_THAT([&] { measurements.addPictures(threeRows(), px); }, ThrowsMessage<InvalidArgument>(HasSubstr(words)));
    EXPECT_THAT(measurements.samples, IsEmpty());
  };
  std::vector<Eigen::MatrixX2d> px = threePictures();
  px.pop_back();
  refuses(px, "2 pictures for 3 samples");
  px = threePictures();
  px[1] = Eigen::MatrixX2d::Zero(3, 2);
  refuses(px, "picture 1: 3 corners, expected 4");
  px = threePictures();
  px[1](0, 1) = kUnseen;
  refuses(px, "picture 1: tag 7, corner 0 is half a number");
}

TEST(Measurements, PosesAndPositionsAreAddedRowByRow) {
  Rng rng = test::rngOfThisTest();
  const std::vector<Eigen::Isometry3d> T{test::randomPose(rng), test::randomPose(rng), test::randomPose(rng)};
  Measurements poses;
  poses.addPoses(threeRows(), T, 1e-4, 1e-3);
  ASSERT_THAT(poses.observations, SizeIs(3));
  EXPECT_TRUE(poses.sigmas_stated);
  EXPECT_THAT(poses.observations[2].pose->T_camera_target, test::PoseIsNear(T[2], 0.0));
  EXPECT_EQ(poses.observations[2].q(0), 0.3);
  Measurements positions;
  positions.addPositions(threeRows(), (Eigen::MatrixX3d(3, 3) << 1, 2, 3, 4, 5, 6, 7, 8, 9).finished());
  EXPECT_FALSE(positions.sigmas_stated);
  EXPECT_TRUE(positions.observations.at(1).pose->position_only);
  EXPECT_EQ(positions.observations.at(1).pose->T_camera_target.translation(), Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_THAT([&] { poses.addPoses(threeRows(), {}); }, ThrowsMessage<InvalidArgument>(HasSubstr("0 poses for 3 samples")));
}

TEST(Measurements, ReferenceTagsStandBesideTheTarget) {
  Capture capture;
  capture.target = apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}});
  capture.reference = apriltagTarget("tag36h11", {{.id = 40, .size = 0.2}});
  capture.table = threeRows();
  Detections detections;
  for (std::size_t k = 0; k < 3; ++k) {
    Sample& sample = capture.table.samples[k];
    sample.image = std::to_string(k) + ".png";
    detections.images.push_back({.image = sample.image, .corners = {}});
    for (int corner = 0; corner < 4; ++corner) {
      const double at = static_cast<double>(corner);
      detections.images.back().corners.push_back({.id = {7, corner}, .px = {at, 1.0}});
      // The last picture shows the target alone.
      if (k < 2) detections.images.back().corners.push_back({.id = {40, corner}, .px = {at, 2.0}});
    }
  }
  const Measurements measurements = measurementsOf(capture, detections);
  ASSERT_THAT(measurements.observations, SizeIs(3));
  for (const Observation& observation : measurements.observations) EXPECT_THAT(observation.corners, SizeIs(4));
  ASSERT_THAT(measurements.observations[1].reference, SizeIs(4));
  const CornerMeasurement& corner = measurements.observations[1].reference[2];
  EXPECT_EQ(corner.px, Eigen::Vector2d(2.0, 2.0));
  EXPECT_EQ(corner.p_target, capture.reference->find(corner.id)->p_target);
  EXPECT_THAT(measurements.observations[2].reference, IsEmpty());
}

TEST(Measurements, TablesWithOtherFurtherColumnsDoNotMix) {
  Measurements poses;
  const std::vector<Eigen::Isometry3d> T(3, Eigen::Isometry3d::Identity());
  poses.addPoses(threeRows(), T);
  SampleTable other = threeRows();
  other.other_columns = {"load"};
  EXPECT_THAT([&] { poses.addPoses(other, T); }, ThrowsMessage<InvalidArgument>(HasSubstr("load, expected humidity")));
}

}  // namespace
}  // namespace poecal
