#include <gmock/gmock.h>
#include <opencv2/aruco/charuco.hpp>

#include "detection/marker_bitmap.hpp"
#include "poecal/core/error.hpp"
#include "simulation/pattern.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

Tile tileAt(const PrintedFace& face, double x, double y) { return face.tile(face.cellAt(x, y)); }

TEST(PrintedFace, LaterRectanglesCoverEarlierOnes) {
  const PrintedFace face(Eigen::Isometry3d::Identity(), {{{Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 2)}, Tile::kPaper},
                                                         {{Eigen::Vector2d(1, 0), Eigen::Vector2d(2, 1)}, Tile::kInk}});
  EXPECT_EQ(tileAt(face, 0.5, 0.5), Tile::kPaper);
  EXPECT_EQ(tileAt(face, 1.5, 0.5), Tile::kInk);
  EXPECT_EQ(tileAt(face, 1.5, 1.5), Tile::kPaper);
  EXPECT_EQ(tileAt(face, -0.1, 0.5), Tile::kNone);
  EXPECT_EQ(tileAt(face, 4.1, 0.5), Tile::kNone);
  EXPECT_EQ(face.cellAt(1.1, 0.2), face.cellAt(1.9, 0.9));
  EXPECT_NE(face.cellAt(0.9, 0.2), face.cellAt(1.1, 0.2));
}

TEST(PrintedFace, EdgesThatDifferByRoundingAreOne) {
  // 3 * 0.1 is not 0.3: without care a sliver of a cell would lie between the two rectangles.
  const PrintedFace face(Eigen::Isometry3d::Identity(), {{{Eigen::Vector2d(0, 0), Eigen::Vector2d(3 * 0.1, 1)}, Tile::kInk},
                                                         {{Eigen::Vector2d(0.3, 0), Eigen::Vector2d(1, 1)}, Tile::kPaper}});
  EXPECT_EQ(face.cellAt(0.9, 0.5), 1);
}

TEST(PrintedFace, SharesOfAQuadrilateralAreItsAreas) {
  // Ink on [1, 2] x [0, 1] of paper on [0, 4] x [0, 2].
  const PrintedFace face(Eigen::Isometry3d::Identity(), {{{Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 2)}, Tile::kPaper},
                                                         {{Eigen::Vector2d(1, 0), Eigen::Vector2d(2, 1)}, Tile::kInk}});
  const auto shares = [&face](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
    Eigen::Matrix<double, 2, 4> corners;
    corners << a, b, c, d;
    const TileShares areas = face.shares(corners);
    return Eigen::Vector4d(areas[0], areas[1], areas[2], areas[3]);  // none, plate, paper, ink
  };
  constexpr double kRounding = 1e-15;
  // A square of area 1 that overhangs on top by 0.5 and covers 0.25 x 0.5 of the ink.
  EXPECT_THAT(shares({0.25, -0.5}, {1.25, -0.5}, {1.25, 0.5}, {0.25, 0.5}),
              test::IsNear(Eigen::Vector4d(0.5, 0.0, 0.375, 0.125), kRounding));
  // Turned by 45 degrees about the ink's corner (1, 1): a quarter of it.
  EXPECT_THAT(shares({1.0, 0.5}, {1.5, 1.0}, {1.0, 1.5}, {0.5, 1.0}), test::IsNear(Eigen::Vector4d(0.0, 0.0, 0.75, 0.25), kRounding));
  // Wholly beside it, and the whole of it, the other way round.
  EXPECT_THAT(shares({5.0, 0.0}, {6.0, 0.0}, {6.0, 1.0}, {5.0, 1.0}), test::IsNear(Eigen::Vector4d::Unit(0).eval(), kRounding));
  EXPECT_THAT(shares({0.0, 0.0}, {0.0, 2.0}, {4.0, 2.0}, {4.0, 0.0}), test::IsNear(Eigen::Vector4d(0.0, 0.0, 0.875, 0.125), kRounding));
}

class TagFamilies : public testing::TestWithParam<const char*> {};

TEST_P(TagFamilies, CornersLieOnTheBorderOfInkAndPaper) {
  // Across each side of the square of the corners the colour changes all along: black within and white without, or the other way round.
  const double size = 0.08;
  const PrintedFace face = printedFaces(apriltagTarget(GetParam(), {{.id = 5, .size = size}})).front();
  const double half = size / 2.0, step = size / 1000.0;
  for (double along = -0.9 * half; along < half; along += size / 50.0) {
    for (const double side : {-1.0, 1.0}) {
      EXPECT_NE(tileAt(face, along, side * (half - step)), tileAt(face, along, side * (half + step)));
      EXPECT_NE(tileAt(face, side * (half - step), along), tileAt(face, side * (half + step), along));
    }
  }
}

TEST_P(TagFamilies, PaperThenPlateSurroundTheTag) {
  const MarkerBitmap bitmap = tagBitmap(GetParam(), 5);
  const double cell = 0.08 / bitmap.corner_width, outside = cell * bitmap.width / 2.0;
  const PrintedFace face = printedFaces(apriltagTarget(GetParam(), {{.id = 5, .size = 0.08}})).front();
  EXPECT_EQ(tileAt(face, outside + 0.5 * cell, 0.0), Tile::kPaper);
  EXPECT_EQ(tileAt(face, 0.0, -outside - 1.5 * cell), Tile::kPlate);
  EXPECT_EQ(tileAt(face, 0.0, -outside - 2.5 * cell), Tile::kNone);
}

INSTANTIATE_TEST_SUITE_P(Pattern, TagFamilies, testing::Values("tag36h11", "tag25h9", "tag16h5", "tagStandard41h12", "tagStandard52h13"));

TEST(Pattern, CharucoIsTheBoardThatOpenCvDraws) {
  constexpr int kCols = 5, kRows = 4, kPixelsOfSquare = 64, kPixelsOfMarker = 48;
  const Target target = charucoTarget(kCols, kRows, 0.04, 0.03, "DICT_5X5_100");
  const auto board =
      cv::aruco::CharucoBoard::create(kCols, kRows, 0.04F, 0.03F, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100));
  cv::Mat drawn;
  board->draw(cv::Size(kCols * kPixelsOfSquare, kRows * kPixelsOfSquare), drawn, 0, 1);
  const PrintedFace face = printedFaces(target).front();
  // At the middle of each module of each marker, where OpenCV's rounding to whole pixels cannot reach. 48 pixels are 7 modules of 6.9.
  int compared = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kCols; ++column) {
      for (int module_row = 0; module_row < 7; ++module_row) {
        for (int module_column = 0; module_column < 7; ++module_column) {
          const double u = column * kPixelsOfSquare + 8 + (module_column + 0.5) * kPixelsOfMarker / 7.0;
          const double v = row * kPixelsOfSquare + 8 + (module_row + 0.5) * kPixelsOfMarker / 7.0;
          const bool white = drawn.at<std::uint8_t>(static_cast<int>(v), static_cast<int>(u)) > 127;
          const Tile tile = tileAt(face, u * 0.04 / kPixelsOfSquare, v * 0.04 / kPixelsOfSquare);
          ASSERT_EQ(tile, white ? Tile::kPaper : Tile::kInk) << "square " << column << ", " << row;
          ++compared;
        }
      }
    }
  }
  EXPECT_EQ(compared, kCols * kRows * 49);
}

TEST(Pattern, ChessboardChangesColourAcrossEachInnerCorner) {
  const Target target = chessboardTarget(4, 3, 0.03);
  const PrintedFace face = printedFaces(target).front();
  for (const TargetPoint& point : target.points) {
    const double x = point.p_target.x(), y = point.p_target.y(), step = 0.001;
    EXPECT_EQ(tileAt(face, x - step, y - step), tileAt(face, x + step, y + step));
    EXPECT_NE(tileAt(face, x - step, y - step), tileAt(face, x + step, y - step));
  }
  EXPECT_EQ(tileAt(face, -0.015, -0.015), Tile::kInk) << "the square before corner 0 is dark";
}

TEST(Pattern, AprilgridHasKalibrsSquaresWhereTheGapsCross) {
  const double size = 0.05, gap = 0.3 * size;
  const Target target = aprilgridTarget("tag36h11", 3, 2, size, 0.3, 10);
  const PrintedFace face = printedFaces(target).front();
  const Eigen::Isometry3d T_face_target = face.T_target_face().inverse();
  const auto tileAtTarget = [&](double x, double y) {
    const Eigen::Vector3d p_face = T_face_target * Eigen::Vector3d(x, y, 0.0);
    EXPECT_NEAR(p_face.z(), 0.0, 1e-15);
    return tileAt(face, p_face.x(), p_face.y());
  };
  for (int row = 0; row <= 2; ++row) {
    for (int column = 0; column <= 3; ++column) {
      const double x = column * (size + gap), y = row * (size + gap);
      EXPECT_EQ(tileAtTarget(x - gap / 2.0, y - gap / 2.0), Tile::kInk) << column << ", " << row;
      if (column < 3) {
        EXPECT_EQ(tileAtTarget(x + size / 2.0, y - gap / 2.0), Tile::kPaper) << "between the squares";
      }
    }
  }
  // Just inside and outside of corner 2 (top right) of the last tag: its black border, and Kalibr's square.
  const Eigen::Vector3d corner = target.find({15, 2})->p_target;
  EXPECT_EQ(tileAtTarget(corner.x() - 0.001, corner.y() - 0.001), Tile::kInk);
  EXPECT_EQ(tileAtTarget(corner.x() + 0.001, corner.y() + 0.001), Tile::kInk);
  EXPECT_EQ(tileAtTarget(corner.x() + 0.001, corner.y() - 0.001), Tile::kPaper);
}

TEST(Pattern, SinglePointsCannotBeDrawn) { EXPECT_THROW(printedFaces(pointsTarget({{{3, 0}, {0.1, 0, 0}}})), InvalidArgument); }

TEST(MarkerBitmap, IdsThatTheFamilyDoesNotHaveAreErrors) {
  EXPECT_THROW(tagBitmap("tag36h11", 587), InvalidArgument);
  EXPECT_THROW(tagBitmap("tag36h11", -1), InvalidArgument);
  EXPECT_THROW(tagBitmap("tag99h9", 0), InvalidArgument);
  EXPECT_THROW(arucoBitmap("DICT_4X4_50", 50), InvalidArgument);
}

}  // namespace
}  // namespace poecal
