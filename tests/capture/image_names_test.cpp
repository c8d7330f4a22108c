#include "poecal/capture/image_names.hpp"

#include <gmock/gmock.h>

#include "capture/test_arm.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ImageNames, TheSamePlaceHasOneName) {
  for (const char* name : {"images/a.png", "./images/a.png", "images//a.png", "images/./a.png", "images\\a.png", ".\\images\\a.png"}) {
    EXPECT_EQ(imageName(name), "images/a.png") << name;
  }
  EXPECT_EQ(imageName("/data/a.png"), "/data/a.png");
  EXPECT_EQ(imageName("../a.png"), "../a.png");
  EXPECT_EQ(imageName(""), "");
}

class ImagesMeet : public ::testing::Test {
 protected:
  /// Rows from line 2 on, and pictures of which each has one corner.
  std::vector<std::string> check(const std::vector<std::string>& rows, const std::vector<std::string>& pictures) const {
    SampleTable table;
    table.file = "capture/samples.csv";
    for (const std::string& row : rows) {
      Sample& sample = table.samples.emplace_back();
      sample.image = row;
      sample.line = static_cast<int>(table.samples.size()) + 1;
    }
    Detections detections;
    for (const std::string& picture : pictures) detections.images.push_back({picture, {Corner{}}});
    return checkImagesMeet(table, detections, "capture/detections.csv");
  }
};

TEST_F(ImagesMeet, WhereAllHaveARowNothingIsSaid) {
  EXPECT_THAT(check({"a", "b", "c"}, {"c", "a", "b"}), IsEmpty());
  EXPECT_THAT(check({"a", "b", "c"}, {"b"}), IsEmpty()) << "the target was not seen in the others";
  EXPECT_THAT(check({"a", "b"}, {}), IsEmpty());
}

TEST_F(ImagesMeet, BothSidesAreToldWithTheirFirst) {
  EXPECT_THAT(check({"a", "b", "c", "d"}, {"a", "x/c", "x/d", "b"}),
              ElementsAre("2 pictures of detections.csv without a row in samples.csv (the first: 'x/c'), "
                          "2 rows of samples.csv without corners (the first: line 4, 'c')"));
  EXPECT_THAT(check({"a"}, {"a", "b"}), ElementsAre("1 picture of detections.csv without a row in samples.csv (the first: 'b')"));
}

TEST_F(ImagesMeet, WhereNoneMeetsIsAnError) {
  EXPECT_THAT(test::messageOf<FileError>([&] {
                check({"a.png", "b.png"}, {"images/a.png", "images/b.png"});
              }),
              HasSubstr("samples.csv:2: 'a.png' is not in detections.csv (which has 'images/a.png'), expected the same names"));
}

TEST_F(ImagesMeet, BothFilesAreReadWithTheirNamesMadeAlike) {
  const test::TempFolder folder;
  const auto samples = folder.write("samples.csv", "image,q1\n./images\\a.png,0.1\nimages//b.png,0.2\n");
  const auto corners = folder.write("detections.csv", "image,tag,corner,u,v\nimages/a.png,7,0,1,1\n.\\images/b.png,7,0,1,1\n");
  const SampleTable table = readSamples(samples, 1, nullptr);
  const Detections detections = readDetections(corners, apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}}));
  EXPECT_EQ(table.samples[0].image, "images/a.png");
  EXPECT_THAT(checkImagesMeet(table, detections, corners), IsEmpty());
  EXPECT_THAT(test::messageOf<FileError>([&] { readSamples(folder.write("twice.csv", "image,q1\na.png,0.1\n./a.png,0.2\n"), 1, nullptr); }),
              HasSubstr("twice.csv:3: image 'a.png' is in line 2 already"));
}

}  // namespace
}  // namespace poecal
