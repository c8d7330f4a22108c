#include "poecal/capture/detections.hpp"

#include <optional>

#include <gmock/gmock.h>

#include "capture/test_arm.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

class DetectionsFile : public ::testing::Test {
 protected:
  Detections read(const std::string& rows) const {
    return readDetections(folder_.write("detections.csv", "image,tag,corner,u,v\n" + rows), target_);
  }
  std::string errorOf(const std::string& rows) const {
    return test::messageOf<FileError>([&] { read(rows); });
  }
  test::TempFolder folder_;
  Target target_ =
      apriltagTarget("tag36h11", {{7, 0.08, Eigen::Isometry3d::Identity()}, {3, 0.08, Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0))}});
};

TEST_F(DetectionsFile, CornersAreSortedAndPicturesKeepTheirOrder) {
  const Detections detections = read("b.png,7,1,10.5,20.25\na.png,7,0,1,2\nb.png,3,2,5,6\n");
  ASSERT_EQ(detections.images.size(), 2u);
  EXPECT_EQ(detections.images[0].image, "b.png");
  EXPECT_EQ(detections.images[0].corners[0].id, (PointId{3, 2}));
  EXPECT_THAT(detections.images[0].corners[1].px, test::IsNear(Eigen::Vector2d(10.5, 20.25), 0.0));
  EXPECT_EQ(detections.find("a.png")->corners.size(), 1u);
  EXPECT_EQ(detections.find("c.png"), nullptr);
}

TEST_F(DetectionsFile, WhatIsWrittenReadsBackBitForBit) {
  Detections detections;
  detections.images = {{"a.png", {{{3, 0}, {1.0 / 3.0, 2e-7}, NAN}, {{7, 3}, {-0.5, 1e3}, NAN}}}, {"empty.png", {}}};
  const std::string plain = detectionsCsv(detections);
  EXPECT_THAT(plain, HasSubstr("image,tag,corner,u,v\n"));
  detections.images[0].corners[1].sigma = 0.04;
  const auto file = folder_.write("detections.csv", detectionsCsv(detections));
  const Detections back = readDetections(file, target_);
  ASSERT_EQ(back.images.size(), 1u) << "a picture without corners has no rows";
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(back.images[0].corners[k].id, detections.images[0].corners[k].id);
    EXPECT_EQ(back.images[0].corners[k].px, detections.images[0].corners[k].px);
  }
  EXPECT_TRUE(std::isnan(back.images[0].corners[0].sigma));
  EXPECT_EQ(back.images[0].corners[1].sigma, 0.04);
}

TEST_F(DetectionsFile, CornersThatNoPictureHoldsAreRefused) {
  const auto errorIn = [&](const std::string& rows, const std::optional<ImageSize>& size) {
    const auto file = folder_.write("detections.csv", "image,tag,corner,u,v\n" + rows);
    return test::messageOf<FileError>([&] { readDetections(file, target_, nullptr, size); });
  };
  const ImageSize size{640, 480};
  EXPECT_EQ(errorIn("a.png,7,0,-0.5,-0.5\na.png,7,1,639.5,479.5\n", size), "no error");
  EXPECT_EQ(errorIn("a.png,7,0,-6,-4\na.png,7,1,645,484\n", size), "no error") << "a fitted corner may lie a little outside";
  EXPECT_THAT(errorIn("a.png,7,0,1,1\na.png,7,1,953.25,20\n", size),
              HasSubstr("detections.csv:3: u is 953.25, expected -0.5 to 639.5 (a picture of 640 px)"));
  EXPECT_THAT(errorIn("a.png,7,1,20,500\n", size), HasSubstr("detections.csv:2: v is 500.0, expected -0.5 to 479.5"));
  EXPECT_THAT(errorIn("a.png,7,1,-30000,50\n", size), HasSubstr("detections.csv:2: u is -30000.0, expected"));
  EXPECT_THAT(errorIn("a.png,7,1,1e308,50\n", size), HasSubstr("detections.csv:2: u is '1e308', expected a finite number"));
  EXPECT_EQ(errorIn("a.png,7,1,30000,50\n", std::nullopt), "no error") << "of pictures of unknown size";
  EXPECT_THAT(errorIn("a.png,7,1,1e7,50\n", std::nullopt), HasSubstr("detections.csv:2: u is 10000000.0, expected a place in a picture"));
  EXPECT_THAT(errorOf("a.png,4294967303,1,10,50\n"), HasSubstr("is not in the target")) << "7 beyond what an int holds";
}

TEST_F(DetectionsFile, SigmasThatNoWeightComesOfAreRefused) {
  for (const char* sigma : {"0", "-1", "1e-300", "1e9"}) {
    const auto file = folder_.write("detections.csv", std::string("image,tag,corner,u,v,sigma\na.png,7,0,1,1,") + sigma + "\n");
    EXPECT_THAT(test::messageOf<FileError>([&] { readDetections(file, target_); }), HasSubstr("detections.csv:2: sigma is ")) << sigma;
  }
}

TEST_F(DetectionsFile, ErrorsNameLineAndExpectation) {
  EXPECT_THAT(errorOf("a.png,7,0,1,nan\n"), HasSubstr("detections.csv:2: v is 'nan', expected a finite number"));
  EXPECT_THAT(errorOf("a.png,7.5,0,1,1\n"), HasSubstr("detections.csv:2: tag is '7.5', expected an integer"));
  EXPECT_THAT(errorOf("a.png,12,0,1,1\n"), HasSubstr("corner 0 of tag 12 is not in the target, expected tags 3, 7 with corners 0 to 3"));
  EXPECT_THAT(errorOf("a.png,7,4,1,1\n"), HasSubstr("detections.csv:2: corner 4 of tag 7"));
  EXPECT_THAT(errorOf("a.png,7,0,1,1\nb.png,7,0,1,1\na.png,7,0,2,2\n"),
              HasSubstr("detections.csv:4: corner 0 of tag 7 in 'a.png' is in line 2 already"));
  target_ = chessboardTarget(9, 6, 0.1);
  EXPECT_THAT(errorOf("a.png,-1,54,1,1\n"), HasSubstr("expected a chessboard with tag -1 and corners 0 to 53"));
  target_ = pointsTarget({{{5, 0}, {0, 0, 0}}});
  EXPECT_THAT(errorOf("a.png,5,1,1,1\n"), HasSubstr("expected points 5 with corner 0"));
  const auto file = folder_.write("sigma.csv", "image,tag,corner,u,v,sigma\na.png,5,0,1,1,-0.1\n");
  EXPECT_THAT(test::messageOf<FileError>([&] { readDetections(file, target_); }),
              HasSubstr("sigma.csv:2: sigma is -0.1, expected a positive number"));
}

TEST_F(DetectionsFile, ATargetAndItsReferenceShareAFile) {
  const Target reference = pointsTarget({{{50, 0}, {0, 0, 0}}});
  const auto file = folder_.write("detections.csv", "image,tag,corner,u,v\na.png,7,0,1,2\na.png,50,0,3,4\n");
  const std::vector<Corner> corners = readDetections(file, target_, &reference).images[0].corners;
  ASSERT_EQ(corners.size(), 2u);
  EXPECT_EQ(corners[0].id, (PointId{7, 0}));
  EXPECT_EQ(corners[1].id, (PointId{50, 0}));
  EXPECT_THROW(readDetections(file, target_), FileError);
}

TEST(DetectionsReal, PublishedCornersRead) {
  POECAL_REQUIRE_REAL("fr3-charuco");
  const std::filesystem::path folder = test::realFolder() / "fr3-charuco";
  const Detections detections = readDetections(folder / "published_corners.csv", readTarget(folder / "target.yaml"));
  std::size_t corners = 0;
  for (const ImageCorners& image : detections.images) corners += image.corners.size();
  EXPECT_EQ(corners, 552u);
}

}  // namespace
}  // namespace poecal
