#include "detection/picture.hpp"

#include <limits>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "detection/picture_header.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

/// A gradient whose grey values are known everywhere.
cv::Mat gradient() {
  cv::Mat picture(40, 50, CV_8UC1);
  for (int row = 0; row < 40; ++row) {
    for (int col = 0; col < 50; ++col) picture.at<unsigned char>(row, col) = static_cast<unsigned char>(3 * row + 2 * col);
  }
  return picture;
}

std::string encoded(const std::string& extension, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  cv::imencode(extension, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

double largestDifference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(Picture, EveryFormatGivesTheSameGrey) {
  const test::TempFolder folder;
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>(3, gradient()), colour);
  for (const char* name : {"a.png", "a.tif", "a.bmp"}) {
    const std::string extension = std::filesystem::path(name).extension();
    EXPECT_EQ(largestDifference(readPicture(folder.write(name, encoded(extension, gradient()))).grey, gradient()), 0.0) << name;
    EXPECT_EQ(largestDifference(readPicture(folder.write(name, encoded(extension, colour))).grey, gradient()), 0.0) << name << ", colour";
  }
  // JPEG loses a few grey values by design.
  EXPECT_LE(largestDifference(readPicture(folder.write("a.jpg", encoded(".jpg", gradient()))).grey, gradient()), 4.0);
}

TEST(Picture, SixteenBitsAreScaledByTheSensorsRange) {
  const test::TempFolder folder;
  cv::Mat full, twelve;
  gradient().convertTo(full, CV_16U, 257.0);
  gradient().convertTo(twelve, CV_16U, 16.0);
  EXPECT_EQ(largestDifference(readPicture(folder.write("full.png", encoded(".png", full))).grey, gradient()), 0.0);
  EXPECT_LE(largestDifference(readPicture(folder.write("twelve.tif", encoded(".tif", twelve))).grey, gradient()), 1.0)
      << "4080 stands for 4095";
}

TEST(Picture, ADamagedPngIsSaidAndNotByItsLibrary) {
  const test::TempFolder folder;
  const std::string whole = encoded(".png", gradient());
  const std::size_t data = whole.find("IDAT") + 12;
  std::string damaged = whole;
  damaged[data] = static_cast<char>(damaged[data] ^ 0x10);
  ::testing::internal::CaptureStderr();
  const Picture picture = readPicture(folder.write("a.png", damaged));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(picture.grey.empty());
  EXPECT_EQ(picture.problem, "the file is damaged: its checksums are not those of its contents");
}

TEST(Picture, CutFilesAreNoPictures) {
  const test::TempFolder folder;
  for (const char* extension : {".png", ".jpg"}) {
    const std::string whole = encoded(extension, gradient());
    for (const double part : {0.1, 0.5, 0.9, 0.99}) {
      const std::string cut = whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size())));
      const Picture picture = readPicture(folder.write(std::string("cut") + extension, cut));
      EXPECT_TRUE(picture.grey.empty()) << extension << " " << part;
      EXPECT_EQ(picture.problem, "the file is cut short") << extension << " " << part;
    }
    EXPECT_FALSE(readPicture(folder.write(std::string("padded") + extension, whole + std::string(64, '\0'))).grey.empty())
        << "some cameras fill up their files";
  }
  const std::string tiff = encoded(".tif", gradient());
  EXPECT_TRUE(readPicture(folder.write("cut.tif", tiff.substr(0, tiff.size() / 2))).grey.empty());
}

TEST(Picture, TheHeaderStatesTheSize) {
  for (const char* extension : {".png", ".jpg", ".tif", ".bmp", ".pgm", ".ppm"}) {
    cv::Mat picture = gradient();
    if (extension == std::string(".ppm")) cv::merge(std::vector<cv::Mat>(3, gradient()), picture);
    const std::string whole = encoded(extension, picture);
    EXPECT_EQ(sizeInHeader(whole), (ImageSize{50, 40})) << extension;
    // Wherever it is cut there is the same size or none.
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const std::optional<ImageSize> size = sizeInHeader(std::string_view(whole).substr(0, length));
      const bool numbers_may_be_cut = extension == std::string(".pgm") || extension == std::string(".ppm");
      EXPECT_TRUE(!size || numbers_may_be_cut || *size == (ImageSize{50, 40})) << extension << " " << length;
    }
  }
  EXPECT_EQ(sizeInHeader("P5 # taken by hand\n# again\n 640\n480 255\n"), (ImageSize{640, 480}));
  EXPECT_EQ(sizeInHeader("P5 99999999999 7 255\n"), (ImageSize{std::numeric_limits<int>::max(), 7}));
  EXPECT_EQ(sizeInHeader("P5 0 7 255\n"), std::nullopt);
  EXPECT_EQ(sizeInHeader("GIF89a"), std::nullopt);
  EXPECT_EQ(sizeInHeader(""), std::nullopt);
}

TEST(Picture, BigEndianAndLongSizesAreUnderstood) {
  using namespace std::string_literals;
  // Two entries, ImageWidth as SHORT and ImageLength as LONG, in the order of Motorola.
  EXPECT_EQ(sizeInHeader("MM\0*\0\0\0\x08\0\x02\x01\0\0\x03\0\0\0\x01\x02\x80\0\0\x01\x01\0\x04\0\0\0\x01\0\0\x01\xe0"s),
            (ImageSize{640, 480}));
  // A directory that lies behind the end of the file.
  EXPECT_EQ(sizeInHeader("II*\0\xff\xff\xff\xff"s), std::nullopt);
  // A JPEG whose segment has no length worth the name, and one whose fill bytes never end.
  EXPECT_EQ(sizeInHeader("\xff\xd8\xff\xe0\0\0\0\0"s), std::nullopt);
  EXPECT_EQ(sizeInHeader("\xff\xd8" + std::string(10'000, '\xff')), std::nullopt);
}

TEST(Picture, MorePixelsThanAnyCameraHasAreNotDecoded) {
  const test::TempFolder folder;
  EXPECT_EQ(readPicture(folder.write("a.pgm", "P5 20000 10001 255\n")).problem, "is 20000 x 10001 pixels, expected at most 200 million");
  EXPECT_THAT(readPicture(folder.write("b.pgm", "P5 100 100 255\n")).problem, ::testing::HasSubstr("is not a picture that can be read"));
}

TEST(Picture, OtherFilesSayWhatTheyAreNot) {
  const test::TempFolder folder;
  EXPECT_EQ(readPicture(folder.path() / "none.png").problem, "no such file");
  EXPECT_EQ(readPicture(folder.write("empty.png", "")).problem, "the file is empty");
  EXPECT_THAT(readPicture(folder.write("text.png", "hello")).problem, ::testing::HasSubstr("is not a picture that can be read"));
}

}  // namespace
}  // namespace poecal
