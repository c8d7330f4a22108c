#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "detection/corner_finder.hpp"
#include "poecal/detection/board_pictures.hpp"
#include "poecal/detection/detector.hpp"
#include "support/random.hpp"
#include "support/rendering.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::IsEmpty;

/// cols x rows inner corners, one pixel a square, the top-left square black, on a white margin of a square.
cv::Mat boardTexture(int cols, int rows) {
  cv::Mat texture(rows + 3, cols + 3, CV_8UC1, cv::Scalar(255));
  for (int row = 0; row <= rows; ++row) {
    for (int col = 0; col <= cols; ++col) {
      if ((row + col) % 2 == 0) texture.at<unsigned char>(row + 1, col + 1) = 0;
    }
  }
  return texture;
}

/// A picture with the four outer inner corners (first, end of the first row, last, start of the last row) at `ends`.
cv::Mat boardPicture(int cols, int rows, const test::Quad& ends, test::Quad& texture_ends, cv::Size size) {
  texture_ends << 1.5, cols + 0.5, cols + 0.5, 1.5,  //
      1.5, 1.5, rows + 0.5, rows + 0.5;
  cv::Mat picture(size, CV_8UC1, cv::Scalar(255));
  test::drawTexture(picture, boardTexture(cols, rows), texture_ends, ends);
  return picture;
}

TEST(Chessboard, RenderedCornersAreInOrderWhicheverWayTheBoardIsTurned) {
  // cornerSubPix on noisy saddles of 0.7 px blur: about 0.03 px rms.
  constexpr double kMean = 0.03;
  constexpr double kRms = 0.08;
  Rng rng = test::rngOfThisTest();
  const auto finder = makeChessboardFinder(chessboardTarget(6, 5, 0.02));
  test::CornerErrors errors;
  for (int turn = 0; turn < 4; ++turn) {
    test::Quad ends;
    ends << -100, 105, 95, -90, -80, -85, 82, 78;
    const double angle = 1.57 * turn + 0.1;
    const Eigen::Matrix2d R = (Eigen::Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
    ends = (R * ends).colwise() + Eigen::Vector2d(200.3, 200.6);
    test::Quad texture_ends;
    cv::Mat picture = boardPicture(6, 5, ends, texture_ends, {400, 400});
    test::degrade(picture, rng, 0.7, 1.0);
    const FoundCorners finding = finder->find(picture);
    ASSERT_EQ(finding.corners.size(), 30u) << "turn " << turn;
    for (int k = 0; k < 30; ++k) {
      const Eigen::Vector2d p(1.5 + k % 6, 1.5 + k / 6);
      errors.errors.push_back(finding.corners[k].px - test::mapPoints(p, texture_ends, ends).col(0));
    }
  }
  EXPECT_LT(errors.mean().cwiseAbs().maxCoeff(), kMean) << errors.mean().transpose();
  EXPECT_LT(errors.rmsAboutMean(), kRms);
}

TEST(Chessboard, NoBoardIsSaid) {
  const auto finder = makeChessboardFinder(chessboardTarget(9, 6, 0.02));
  EXPECT_THAT(finder->find(cv::Mat(100, 100, CV_8UC1, cv::Scalar(128))).notes,
              ::testing::ElementsAre("no chessboard of 9 x 6 inner corners was found"));
}

TEST(Chessboard, ABoardOfAnotherSizeIsNamed) {
  Rng rng = test::rngOfThisTest();
  test::Quad ends, texture_ends;
  ends << 120, 500, 470, 140, 90, 130, 380, 350;
  cv::Mat picture = boardPicture(9, 6, ends, texture_ends, {640, 480});
  test::degrade(picture, rng, 0.8, 2.0);
  const auto notes = [&](int cols, int rows) { return makeChessboardFinder(chessboardTarget(cols, rows, 0.02))->find(picture).notes; };
  EXPECT_THAT(notes(10, 7), ::testing::ElementsAre("no chessboard of 10 x 7 inner corners was found; one of 9 x 6 was: cols and rows "
                                                   "count inner corners"));
  EXPECT_THAT(notes(7, 10), ::testing::ElementsAre("no chessboard of 7 x 10 inner corners was found; one of 6 x 9 was: cols and rows "
                                                   "count inner corners"));
  EXPECT_THAT(notes(12, 9), ::testing::ElementsAre("no chessboard of 12 x 9 inner corners was found; one of 9 x 6 was"));
  EXPECT_THAT(notes(9, 6), IsEmpty());
  EXPECT_THAT(notes(6, 9), IsEmpty()) << "the same board, turned";
}

TEST(Chessboard, ACopyOfAPictureCountsOnce) {
  Rng rng = test::rngOfThisTest();
  const test::TempFolder folder;
  folder.write("target.yaml", "type: chessboard\ncols: 9\nrows: 6\nsquare: 0.02\n");
  test::Quad ends, texture_ends;
  ends << 120, 500, 470, 140, 90, 130, 380, 350;
  const cv::Mat scene = boardPicture(9, 6, ends, texture_ends, {640, 480});
  for (const char* name : {"a.png", "c.png"}) {
    cv::Mat picture = scene.clone();
    test::degrade(picture, rng, 0.8, 2.0);  // the same pose with other noise is another picture
    cv::imwrite(folder.path() / name, picture);
    if (*name == 'a') cv::imwrite(folder.path() / "b.png", picture);
  }
  const BoardPictures pictures = readBoardPictures(folder.path(), {});
  ASSERT_EQ(pictures.views.size(), 3u);
  EXPECT_EQ(pictures.views[0].pixels.cols(), 54);
  EXPECT_EQ(pictures.views[1].pixels.cols(), 0);
  EXPECT_EQ(pictures.views[2].pixels.cols(), 54);
  EXPECT_THAT(texts(pictures.notes), ::testing::ElementsAre("b.png: is a copy of a.png, left out"));
}

TEST(ChessboardReal, CalibratesAsWellAsPublished) {
  POECAL_REQUIRE_REAL("chessboard-left");
  const std::filesystem::path folder = test::realFolder() / "chessboard-left";
  const Target target = readTarget(folder / "target.yaml");
  const DetectResult result = detect(folder, listPictures(folder), target, {});
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const ImageCorners& picture : result.detections.images) {
    ASSERT_EQ(picture.corners.size(), 54u) << picture.image;
    points.emplace_back();
    pixels.emplace_back();
    for (const Corner& corner : picture.corners) {
      const Eigen::Vector3f p = target.find(corner.id)->p_target.cast<float>();
      points.back().emplace_back(p.x(), p.y(), p.z());
      pixels.back().emplace_back(static_cast<float>(corner.px.x()), static_cast<float>(corner.px.y()));
    }
  }
  ASSERT_EQ(points.size(), 13u);
  cv::Mat K, distortion;
  std::vector<cv::Mat> rotations, translations;
  const double rms = cv::calibrateCamera(points, pixels, {result.width, result.height}, K, distortion, rotations, translations);
  EXPECT_LE(rms, 0.409) << "the best published figure for these pictures";
}

}  // namespace
}  // namespace poecal
