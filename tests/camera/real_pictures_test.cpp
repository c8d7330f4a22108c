// Intrinsics from real pictures, against figures that others published for them.
#include <cmath>

#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "poecal/camera/intrinsics.hpp"
#include "poecal/detection/board_pictures.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

// OpenCV's own sample pictures left01..left14.jpg. What others published for them is from corners refined with windows of 23 px, which
// in chessboard-02 reach over to the neighbours: with it fx 536.07, fy 536.02, 0.409 px, without it 534.13, 534.19, 0.234 px.
constexpr double kShare = 0.002;

std::vector<BoardView> viewsAsPublished(const std::filesystem::path& folder) {
  std::vector<BoardView> views;
  const cv::Size corners(9, 6);
  for (const std::string& name : listPictures(folder)) {
    const cv::Mat grey = cv::imread((folder / name).string(), cv::IMREAD_GRAYSCALE);
    std::vector<cv::Point2f> found;
    EXPECT_TRUE(cv::findChessboardCorners(grey, corners, found)) << name;
    cv::cornerSubPix(grey, found, {11, 11}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01});
    BoardView& view = views.emplace_back(BoardView{name, Eigen::Matrix3Xd(3, 54), Eigen::Matrix2Xd(2, 54)});
    for (int k = 0; k < 54; ++k) {
      view.points.col(k) << 0.025 * (k % 9), 0.025 * (k / 9), 0.0;
      const cv::Point2f& px = found[static_cast<std::size_t>(k)];
      view.pixels.col(k) << px.x, px.y;
    }
  }
  return views;
}

TEST(RealPictures, FiguresPublishedForOpenCvsCorners) {
  POECAL_REQUIRE_REAL("chessboard-left");
  const IntrinsicsResult result = calibrateIntrinsics(viewsAsPublished(test::realFolder() / "chessboard-left"), 640, 480, {});
  EXPECT_NEAR(result.all.camera.fx, 536.07, kShare * 536.07);
  EXPECT_NEAR(result.all.camera.fy, 536.02, kShare * 536.02);
  EXPECT_LE(result.all.rms_px, 0.409);
  for (const ViewResidual& view : result.views) EXPECT_EQ(view.bad, view.image == "chessboard-02.jpg") << view.image;
  // What others published without it counts every corner of the other pictures.
  EXPECT_NEAR(result.robust.camera.fx, 534.13, kShare * 534.13);
  EXPECT_NEAR(result.robust.camera.fy, 534.19, kShare * 534.19);
  EXPECT_LE(result.robust.rms_px, 0.235);
}

TEST(RealPictures, OurDetectorReachesThePublishedFiguresAndNamesTheBadPicture) {
  POECAL_REQUIRE_REAL("chessboard-left");
  const BoardPictures pictures = readBoardPictures(test::realFolder() / "chessboard-left", {});
  ASSERT_EQ(pictures.views.size(), 13U);
  EXPECT_THAT(pictures.notes, testing::IsEmpty());
  const IntrinsicsResult result = calibrateIntrinsics(pictures.views, pictures.width, pictures.height, {});
  EXPECT_LE(result.all.rms_px, 0.409);
  EXPECT_LE(result.chosen().rms_px, 0.24);
  EXPECT_LE(std::abs(result.chosen().camera.fx - 534.1), result.chosen().camera.standard_deviation(0));
  for (const ViewResidual& view : result.views) EXPECT_EQ(view.bad, view.image == "chessboard-02.jpg") << view.image;
}

}  // namespace
}  // namespace poecal
