#include "poecal/detection/detector.hpp"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "poecal/capture/capture.hpp"
#include "poecal/core/error.hpp"
#include "poecal/detection/detect_capture.hpp"
#include "support/rendering.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Detector : public ::testing::Test {
 protected:
  void writeTag(const std::string& name, int id, const test::Quad& corners, cv::Size size = {160, 120},
                const std::string& family = "tag36h11") const {
    cv::imwrite((folder_.path() / name).string(), test::tagPicture(family, id, corners, size));
  }
  test::TempFolder folder_;
  Target target_ = apriltagTarget("tag36h11", {{7, 0.08, Eigen::Isometry3d::Identity()}});
  test::Quad quad_ = test::tiltedSquare({80, 60}, 60.0, 0.2, 0.3);
};

TEST_F(Detector, PicturesKeepTheirOrderAndFailAlone) {
  writeTag("c.png", 7, quad_);
  writeTag("a.png", 9, quad_);
  writeTag("large.png", 7, quad_, {200, 150});
  folder_.write("broken.png", "no picture");
  writeTag("b.png", 7, quad_);
  const DetectResult result = detect(folder_.path(), {"c.png", "broken.png", "a.png", "large.png", "missing.png", "b.png"}, target_, {});
  std::vector<std::string> images, noted;
  std::vector<std::size_t> corners;
  for (const ImageCorners& picture : result.detections.images) {
    images.push_back(picture.image);
    corners.push_back(picture.corners.size());
  }
  for (const PictureNote& note : result.notes) {
    noted.push_back(note.image + " " + note.message);
    EXPECT_TRUE(note.failed) << note.message;
  }
  EXPECT_THAT(images, ElementsAre("c.png", "broken.png", "a.png", "large.png", "missing.png", "b.png"));
  EXPECT_THAT(corners, ElementsAre(4, 0, 0, 0, 0, 4));
  EXPECT_THAT(noted,
              ElementsAre("broken.png is not a picture that can be read, expected PNG, JPEG or TIFF", "a.png tag 9 is not the target's",
                          "large.png is 200 x 150 pixels, expected 160 x 120", "missing.png no such file"));
  EXPECT_EQ(result.width, 160);
  EXPECT_EQ(result.height, 120);
}

TEST_F(Detector, AnotherSizeThanTheCamerasFails) {
  writeTag("a.png", 7, quad_);
  DetectOptions options;
  options.expected_width = 640;
  options.expected_height = 480;
  const DetectResult result = detect(folder_.path(), {"a.png"}, target_, options);
  EXPECT_THAT(result.detections.images[0].corners, IsEmpty());
  EXPECT_EQ(result.notes.at(0).message, "is 160 x 120 pixels, expected 640 x 480");
}

TEST_F(Detector, TheNumberOfJobsChangesNothing) {
  std::vector<std::string> images;
  for (int k = 0; k < 9; ++k) {
    images.push_back(std::to_string(k) + ".png");
    writeTag(images.back(), k % 3 == 0 ? 9 : 7, test::tiltedSquare({80, 60}, 40.0 + 3 * k, 0.3 * k, 0.4));
  }
  DetectOptions one, many;
  one.jobs = 1;
  many.jobs = 4;
  const DetectResult a = detect(folder_.path(), images, target_, one);
  const DetectResult b = detect(folder_.path(), images, target_, many);
  EXPECT_EQ(detectionsCsv(a.detections), detectionsCsv(b.detections));
  ASSERT_EQ(a.notes.size(), b.notes.size());
  for (std::size_t k = 0; k < a.notes.size(); ++k) EXPECT_EQ(a.notes[k].message, b.notes[k].message);
}

TEST_F(Detector, AnotherFamilyThanStatedIsNamed) {
  writeTag("a.png", 7, quad_, {160, 120}, "tag25h9");
  const DetectResult result = detect(folder_.path(), {"a.png"}, target_, {});
  ASSERT_EQ(result.notes.size(), 2u);
  EXPECT_EQ(result.notes[0].message, "no tag of family tag36h11 was found");
  EXPECT_EQ(result.notes[1].message, "tags of family tag25h9 were seen; target.yaml says tag36h11");
}

TEST_F(Detector, ImpossibleOptionsAreRefused) {
  DetectOptions options;
  options.quad_decimate = 0.5;
  EXPECT_THROW(detect(folder_.path(), {}, target_, options), InvalidArgument);
  options = {};
  options.jobs = -1;
  EXPECT_THROW(options.validate(), InvalidArgument);
  options = {};
  options.expected_width = 640;
  EXPECT_THROW(options.validate(), InvalidArgument);
  EXPECT_THROW(detect(folder_.path(), {}, pointsTarget({{{1, 0}, {0, 0, 0}}}), {}), InvalidArgument);
}

TEST_F(Detector, PicturesOfAFolderAreSortedByName) {
  for (const char* name : {"b.PNG", "a.jpeg", "notes.txt", "c.tiff"}) folder_.write(name, "");
  EXPECT_THAT(listPictures(folder_.path()), ElementsAre("a.jpeg", "b.PNG", "c.tiff"));
  EXPECT_THROW(listPictures(folder_.path() / "none"), FileError);
}

TEST_F(Detector, AReferenceInViewStandsBesideTheTarget) {
  cv::Mat picture(120, 240, CV_8UC1, cv::Scalar(255));
  for (const auto& [id, x] : {std::pair(7, 60.0), std::pair(9, 180.0)}) {
    const test::TagTexture tag = test::tagTexture("tag36h11", id);
    test::drawTexture(picture, tag.texture, tag.corners, test::tiltedSquare({x, 60}, 60.0, 0.1, 0.1));
  }
  cv::imwrite((folder_.path() / "a.png").string(), picture);
  Capture capture;
  capture.folder = folder_.path();
  capture.target = target_;
  capture.reference = apriltagTarget("tag36h11", {{9, 0.08, Eigen::Isometry3d::Identity()}});
  for (const char* image : {"a.png", "missing.png"}) {
    Sample sample;
    sample.image = image;
    capture.table.samples.push_back(sample);
  }
  const DetectResult result = detectCapture(capture, {});
  ASSERT_EQ(result.detections.images[0].corners.size(), 8u);
  EXPECT_EQ(result.detections.images[0].corners[0].id, (PointId{7, 0}));
  EXPECT_EQ(result.detections.images[0].corners[7].id, (PointId{9, 3}));
  ASSERT_EQ(result.notes.size(), 1u) << "what fails for both is said once";
  EXPECT_EQ(result.notes[0].message, "no such file");
}

TEST(DetectorReal, ASingleTagIsFoundInEveryPicture) {
  POECAL_REQUIRE_REAL("panda-apriltag");
  const std::filesystem::path folder = test::realFolder() / "panda-apriltag";
  const DetectResult result = detect(folder, {"images/1.png", "images/4.png", "images/8.png"}, readTarget(folder / "target.yaml"), {});
  for (const ImageCorners& picture : result.detections.images) EXPECT_EQ(picture.corners.size(), 4u) << picture.image;
}

}  // namespace
}  // namespace poecal
