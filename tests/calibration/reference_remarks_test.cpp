#include "calibration/reference_remarks.hpp"

#include <functional>

#include <gmock/gmock.h>

#include "poecal/cell/measurements.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A capture whose corners were found earlier, in a file that holds the target's beside the reference's.
TEST(ReferenceOfAFile, StandsBesideTheTarget) {
  const test::TempFolder folder;
  Capture capture;
  capture.target = apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}});
  capture.reference = apriltagTarget("tag36h11", {{.id = 50, .size = 0.1}});
  capture.table.samples.resize(1);
  capture.table.samples.front().image = "a.png";
  const auto file = folder.write("detections.csv", "image,tag,corner,u,v\na.png,7,0,1,2\na.png,50,0,3,4\na.png,50,1,5,6\n");
  const Measurements measurements = measurementsOf(capture, readDetections(file, capture.target, &*capture.reference));
  ASSERT_EQ(measurements.observations.size(), 1u);
  ASSERT_EQ(measurements.observations[0].corners.size(), 1u);
  EXPECT_EQ(measurements.observations[0].corners[0].id, (PointId{7, 0}));
  ASSERT_EQ(measurements.observations[0].reference.size(), 2u);
  EXPECT_EQ(measurements.observations[0].reference[1].px, Eigen::Vector2d(5, 6));
}

class ReferenceRemarks : public ::testing::Test {
 protected:
  /// Pictures of one tag. @param place  of its first corner in picture k
  static std::vector<std::string> remarks(int pictures, const std::function<Eigen::Vector2d(int)>& place) {
    Rng rng = test::rngOfThisTest();
    std::vector<Observation> observations(static_cast<std::size_t>(pictures) + 3);  // three pictures do not show it
    for (int k = 0; k < pictures; ++k) {
      for (int corner = 0; corner < 4; ++corner) {
        CornerMeasurement seen;
        seen.id = {50, corner};
        seen.px = place(k) + Eigen::Vector2d(40.0 * corner, 0.0) + 0.2 * Eigen::Vector2d(rng.normal(), rng.normal());
        observations[static_cast<std::size_t>(k)].reference.push_back(seen);
      }
    }
    return remarksOnReference(observations);
  }
};

TEST_F(ReferenceRemarks, WhatStandsStillIsNotRemarked) {
  EXPECT_THAT(remarks(20, [](int) { return Eigen::Vector2d(100, 100); }), IsEmpty());
}

TEST_F(ReferenceRemarks, ACameraThatSlipsOrDriftsIsForTheDiagnosis) {
  EXPECT_THAT(remarks(20, [](int k) { return Eigen::Vector2d(k < 9 ? 100 : 160, 100); }), IsEmpty());
  EXPECT_THAT(remarks(20, [](int k) { return Eigen::Vector2d(100 + 2 * k, 100); }), IsEmpty());
}

TEST_F(ReferenceRemarks, WhatWandersIsNoReference) {
  EXPECT_THAT(remarks(20, [](int k) { return Eigen::Vector2d(100 + 30 * (k % 3), 100); }),
              ElementsAre(HasSubstr("px from picture to picture, expected tags that stand still beside the arm")));
}

TEST_F(ReferenceRemarks, WhatTooFewPicturesShowIsSaid) {
  EXPECT_THAT(remarks(0, [](int) { return Eigen::Vector2d(100, 100); }),
              ElementsAre("reference: is seen in 0 of 3 pictures, 4 are needed: it is not used"));
  EXPECT_THAT(remarks(4, [](int) { return Eigen::Vector2d(100, 100); }), IsEmpty());
}

}  // namespace
}  // namespace poecal
