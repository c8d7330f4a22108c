// Intrinsics from real pictures, against figures that others published for them.
#include <gmock/gmock.h>

#include "poecal/camera/intrinsics.hpp"
#include "poecal/detection/board_pictures.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

// OpenCV's own sample pictures left01..left14.jpg. cv::calibrateCamera gives fx 536.07, fy 536.02, 0.409 px with all of them, and
// 534.13, 534.19, 0.234 px without the one whose corners are wrong.
TEST(RealPictures, ChessboardOfOpenCvsSamples) {
  POECAL_REQUIRE_REAL("chessboard-left");
  const BoardPictures pictures = readBoardPictures(test::realFolder() / "chessboard-left", {});
  ASSERT_EQ(pictures.views.size(), 13U);
  const IntrinsicsResult result = calibrateIntrinsics(pictures.views, pictures.width, pictures.height, {});
  constexpr double kShare = 0.002;  // a detector of one's own moves the corners by some hundredths of a pixel
  EXPECT_NEAR(result.all.camera.fx, 536.07, kShare * 536.07);
  EXPECT_NEAR(result.all.camera.fy, 536.02, kShare * 536.02);
  EXPECT_LE(result.all.rms_px, 0.409);
  for (const ViewResidual& view : result.views) EXPECT_EQ(view.bad, view.image == "chessboard-02.jpg") << view.image;
  ASSERT_TRUE(result.without_bad);
  EXPECT_NEAR(result.without_bad->camera.fx, 534.13, kShare * 534.13);
  EXPECT_NEAR(result.without_bad->camera.fy, 534.19, kShare * 534.19);
  EXPECT_NEAR(result.without_bad->rms_px, 0.234, 0.01);
}

}  // namespace
}  // namespace poecal
