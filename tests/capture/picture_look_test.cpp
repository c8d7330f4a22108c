// The table beside detections.csv: what is written is read, and what is wrong has its line.
#include "poecal/capture/picture_look.hpp"

#include <gmock/gmock.h>

#include "poecal/capture/detections.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

TEST(PictureLook, WhatIsWrittenIsReadBitByBitWithoutPicturesThatHaveNone) {
  const test::TempFolder folder;
  Detections detections;
  detections.images = {{"a.png", {}, PictureLook{1.0 / 3.0, 0.1, -1e-3}}, {"b.png", {}}, {"c, d.png", {}, PictureLook{0.7, 2.0, 0.25}}};
  const std::string csv = picturesCsv(detections);
  EXPECT_THAT(csv, HasSubstr("image,blur,noise,growth\na.png,"));
  EXPECT_THAT(csv, HasSubstr("\"c, d.png\",0.7"));
  const std::vector<PictureLook> looks = readPictureLooks(folder.write("pictures.csv", csv));
  ASSERT_EQ(looks.size(), 2u);
  EXPECT_EQ(looks[0].blur, 1.0 / 3.0);
  EXPECT_EQ(looks[0].noise, 0.1);
  EXPECT_EQ(looks[0].growth, -1e-3);
  EXPECT_EQ(looks[1].growth, 0.25);
}

TEST(PictureLook, StandsBesideTheDetectionsUnderTheirName) {
  EXPECT_EQ(picturesFile("out/detections.csv"), "out/detections-pictures.csv");
  EXPECT_EQ(picturesFile("corners"), "corners-pictures");
}

TEST(PictureLook, TheMedianIsOfEachFigureByItself) {
  EXPECT_FALSE(medianLook({}));
  const auto look = medianLook({{0.5, 9.0, 0.1}, {0.7, 1.0, -0.2}, {3.0, 2.0, 0.0}});
  ASSERT_TRUE(look);
  EXPECT_EQ(look->blur, 0.7);
  EXPECT_EQ(look->noise, 2.0);
  EXPECT_EQ(look->growth, 0.0);
}

TEST(PictureLook, ATableByHandNeedsBlurAndNoiseAlone) {
  const test::TempFolder folder;
  const std::vector<PictureLook> looks = readPictureLooks(folder.write("looks.csv", "blur,noise,lamp\n0.7,2,on\n"));
  ASSERT_EQ(looks.size(), 1u);
  EXPECT_EQ(looks[0].growth, 0.0);
}

TEST(PictureLook, ErrorsNameLineAndExpectation) {
  const test::TempFolder folder;
  const auto errorOf = [&folder](const std::string& text) -> std::string {
    try {
      readPictureLooks(folder.write("looks.csv", text));
    } catch (const FileError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(errorOf("blur\n0.7\n"), HasSubstr("looks.csv:1: "));
  EXPECT_THAT(errorOf("blur,noise\n0.7,2\n-0.1,2\n"), HasSubstr("looks.csv:3: blur is -0.1, expected 0 to 30.0"));
  EXPECT_THAT(errorOf("blur,noise\n0.7,much\n"), HasSubstr("looks.csv:2: "));
  EXPECT_THAT(errorOf("blur,noise\n"), HasSubstr("looks.csv:1: has no rows, expected blur and noise of at least one picture"));
}

}  // namespace
}  // namespace poecal
