#include <map>
#include <set>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "detection/corner_finder.hpp"
#include "detection/picture.hpp"
#include "detection/tag_detector.hpp"
#include "detection/tag_family.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "support/random.hpp"
#include "support/rendering.hpp"
#include "support/temp_folder.hpp"
#include "target/names.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Eigen::Isometry3d kIdentity = Eigen::Isometry3d::Identity();

std::unique_ptr<CornerFinder> finderOf(const std::string& family, const std::vector<int>& ids, double quad_decimate = 2.0) {
  std::vector<TargetTag> tags;
  for (const int id : ids) tags.push_back({id, 0.1, kIdentity});
  DetectOptions options;
  options.quad_decimate = quad_decimate;
  return makeAprilTagFinder(apriltagTarget(family, tags), options);
}

class RenderedTag : public ::testing::TestWithParam<const char*> {};

TEST_P(RenderedTag, CornersAreInOrderAndAtOpenCvsPixels) {
  // Measured on libapriltag 3.3.0: 0.04 to 0.06 px rms, and no more than 0.02 px on the mean of 96 corners. Without the half pixel the
  // mean would be off by 0.5, in another order by a side.
  constexpr double kMean = 0.03;
  constexpr double kRms = 0.08;
  Rng rng = test::rngOfThisTest();
  const std::string family = GetParam();
  const auto finder = finderOf(family, {7});
  test::CornerErrors errors;
  for (int trial = 0; trial < 24; ++trial) {
    const Eigen::Vector2d centre(rng.uniform(90.0, 150.0), rng.uniform(90.0, 150.0));
    const test::Quad truth = test::tiltedSquare(centre, rng.uniform(70.0, 110.0), rng.uniform(-3.1, 3.1), rng.uniform(0.0, 0.7));
    cv::Mat picture = test::tagPicture(family, 7, truth, {240, 240});
    test::degrade(picture, rng, 0.7, 1.0);
    const FoundCorners finding = finder->find(picture);
    ASSERT_EQ(finding.corners.size(), 4u) << "trial " << trial;
    for (int corner = 0; corner < 4; ++corner) {
      EXPECT_EQ(finding.corners[corner].id, (PointId{7, corner}));
      errors.errors.push_back(finding.corners[corner].px - truth.col(corner));
    }
  }
  EXPECT_LT(errors.mean().cwiseAbs().maxCoeff(), kMean) << errors.mean().transpose();
  EXPECT_LT(errors.rmsAboutMean(), kRms);
}

INSTANTIATE_TEST_SUITE_P(Families, RenderedTag, ::testing::Values("tag36h11", "tag25h9", "tagStandard41h12"));

TEST(AprilTag, EveryNamedFamilyHasADetectorWithAsManyIds) {
  for (const IdSet& family : tagFamilies()) {
    EXPECT_EQ(TagDetector(std::string(family.name), 0).idCount(), family.count) << family.name;
    EXPECT_LE(correctableBits(std::string(family.name)), 2);
  }
  EXPECT_THROW(TagDetector("tag99"), InvalidArgument);
}

TEST(AprilTag, ATagTooSmallForTheQuickPassIsFoundByTheThoroughOne) {
  const test::Quad truth = test::tiltedSquare({60.0, 60.0}, 15.0, 0.3, 0.2);
  cv::Mat picture = test::tagPicture("tag36h11", 7, truth, {120, 120});
  Rng rng = test::rngOfThisTest();
  test::degrade(picture, rng, 0.5, 1.0);
  TagDetector detector("tag36h11");
  ASSERT_THAT(detector.detect(picture, 4.0, true), IsEmpty());
  EXPECT_EQ(finderOf("tag36h11", {7}, 4.0)->find(picture).corners.size(), 4u);
}

TEST(AprilTag, StrangersAndTwinsAreNamed) {
  cv::Mat picture(240, 480, CV_8UC1, cv::Scalar(255));
  const auto draw = [&](int id, double x, double y) {
    const test::TagTexture tag = test::tagTexture("tag36h11", id);
    test::drawTexture(picture, tag.texture, tag.corners, test::tiltedSquare({x, y}, 60.0, 0.1, 0.1));
  };
  draw(7, 60, 60);
  draw(3, 180, 60);
  draw(3, 180, 180);
  draw(12, 300, 60);
  draw(20, 420, 60);
  DetectOptions options;
  options.other_tags = {20};
  const FoundCorners finding =
      makeAprilTagFinder(apriltagTarget("tag36h11", {{7, 0.1, kIdentity}, {3, 0.1, kIdentity}}), options)->find(picture);
  EXPECT_THAT(finding.notes, ElementsAre("tag 3 is seen 2 times and left out", "tag 12 is not the target's"));
  ASSERT_EQ(finding.corners.size(), 4u);
  EXPECT_EQ(finding.corners.front().id, (PointId{7, 0}));
}

TEST(AprilTag, NoTagIsSaid) {
  const FoundCorners finding = finderOf("tag36h11", {7})->find(cv::Mat(100, 100, CV_8UC1, cv::Scalar(128)));
  EXPECT_THAT(finding.corners, IsEmpty());
  EXPECT_THAT(finding.notes, ElementsAre("no tag of family tag36h11 was found"));
}

TEST(AprilTag, PicturesSmallerThanAnyTagAreNoTrouble) {
  const auto finder = finderOf("tag36h11", {7});
  for (const int size : {1, 2, 7, 16}) EXPECT_THAT(finder->find(cv::Mat(size, size, CV_8UC1, cv::Scalar(128))).corners, IsEmpty()) << size;
}

TEST(AprilTagReal, EveryListedTagIsFoundWithinAPixelInOrder) {
  POECAL_REQUIRE_REAL("apriltag-images");
  const std::filesystem::path folder = test::realFolder() / "apriltag-images";
  // The lists hold the library's unrefined corners less half a pixel. All tags have id 0, so the nearest is taken.
  const CsvTable csv = CsvTable::read(folder / "corners.csv");
  std::map<std::string, std::map<long, test::Quad>> lists;
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    lists[csv.text(row, csv.column("image"))][csv.integer(row, csv.column("instance"))].col(csv.integer(row, csv.column("corner")))
        << csv.number(row, csv.column("u")),
        csv.number(row, csv.column("v"));
  }
  TagDetector detector("tag36h11");
  std::size_t listed = 0;
  for (const auto& [image, quads] : lists) {
    const std::vector<TagDetection> tags = detectThoroughly(detector, readPicture(folder / image).grey);
    EXPECT_EQ(tags.size(), quads.size()) << image;
    for (const auto& [instance, quad] : quads) {
      ++listed;
      double nearest = std::numeric_limits<double>::infinity();
      for (const TagDetection& tag : tags) nearest = std::min(nearest, (tag.px - quad).colwise().norm().maxCoeff());
      EXPECT_LT(nearest, 1.0) << image << ", instance " << instance;
    }
  }
  EXPECT_EQ(listed, 47u);
}

}  // namespace
}  // namespace poecal
