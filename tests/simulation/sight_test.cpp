#include "cell/sight.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "poecal/geometry/se3.hpp"
#include "simulation/board_poses.hpp"
#include "support/cameras.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

Camera pinhole() { return test::plumbBob(640, 480, {500.0, 500.0}, {320.0, 240.0}); }

Eigen::Isometry3d pose(const Eigen::Vector3d& rotation_vector, const Eigen::Vector3d& position) {
  Eigen::Isometry3d T(Eigen::Translation3d{position});
  T.linear() = expSo3(rotation_vector);
  return T;
}

TEST(Sight, TagTiltedByHand) {
  // A tag of 0.1 m, 1 m ahead, tilted by 40 degrees about its x axis: the normal is 40 degrees off the line of sight; the sides along y
  // shrink most.
  const double tilt = 40.0 * M_PI / 180.0;
  const std::vector<FaceSight> sights =
      sightOf(pinhole(), apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}}), pose({tilt, 0, 0}, {0, 0, 1}));
  ASSERT_EQ(sights.size(), 1u);
  EXPECT_NEAR(sights[0].facing_cos, std::cos(tilt), 1e-12);
  EXPECT_TRUE(sights[0].complete);
  const auto pixelOf = [&](double y) { return 500.0 * y * std::cos(tilt) / (1.0 + y * std::sin(tilt)); };
  const double dy = pixelOf(0.05) - pixelOf(-0.05);
  const double dx = 500.0 * 0.05 / (1.0 + 0.05 * std::sin(tilt)) - 500.0 * 0.05 / (1.0 - 0.05 * std::sin(tilt));
  EXPECT_NEAR(sights[0].shortest_side_px, std::hypot(dx, dy), 1e-9);
  for (int corner = 0; corner < 4; ++corner) EXPECT_EQ(sights[0].corners[static_cast<std::size_t>(corner)].id, (PointId{7, corner}));
}

TEST(Sight, FacingOfEveryKindOfTargetIsOneSquarelyInFront) {
  const Eigen::Isometry3d ahead = pose({0, 0, 0}, {0, 0, 2});
  EXPECT_NEAR(sightOf(pinhole(), apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}}), ahead)[0].facing_cos, 1.0, 1e-12);
  EXPECT_NEAR(sightOf(pinhole(), apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}}), ahead * pose({M_PI, 0, 0}, {0, 0, 0}))[0].facing_cos,
              -1.0, 1e-12);
  // The line of sight to a board's centre leans by atan(offset / 2 m).
  const double leaning = 2.0 / std::hypot(2.0, std::hypot(0.06, 0.045));
  EXPECT_NEAR(sightOf(pinhole(), chessboardTarget(5, 4, 0.03), ahead)[0].facing_cos, leaning, 1e-12);
  EXPECT_GT(sightOf(pinhole(), charucoTarget(5, 4, 0.03, 0.02, "DICT_4X4_50"), ahead)[0].facing_cos, 0.99);
  // Kalibr's z comes out of the grid, so its front is seen from the other side.
  EXPECT_LT(sightOf(pinhole(), aprilgridTarget("tag36h11", 2, 2, 0.05, 0.3, 0), ahead)[0].facing_cos, -0.99);
  const FaceSight point = sightOf(pinhole(), pointsTarget({{{3, 0}, {0.1, 0, 0}}}), ahead)[0];
  EXPECT_EQ(point.facing_cos, 1.0);
  EXPECT_TRUE(std::isinf(point.shortest_side_px));
}

TEST(Sight, CornersBehindTheCameraMakeAFaceIncomplete) {
  const std::vector<FaceSight> sights =
      sightOf(pinhole(), apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}}), pose({M_PI / 2, 0, 0}, {0, 0, 0.01}));
  EXPECT_FALSE(sights[0].complete);
  EXPECT_EQ(sights[0].corners.size(), 2u);
}

TEST(Sight, PictureEndsHalfAPixelBeyondItsLastPixelCentre) {
  const Camera camera = pinhole();
  const auto inside = [&](double u, double v, double margin) { return inPicture(camera, {{.id = {1, 0}, .px = {u, v}}}, margin); };
  EXPECT_TRUE(inside(-0.49, 479.49, 0.0));
  EXPECT_FALSE(inside(-0.51, 100.0, 0.0));
  EXPECT_FALSE(inside(100.0, 479.51, 0.0));
  EXPECT_TRUE(inside(32.0, 24.0, 0.05));
  EXPECT_FALSE(inside(31.0, 24.0, 0.05));
  EXPECT_FALSE(inPicture(camera, {}, 0.0));
}

TEST(BoardPoses, ShowTheFrontWholeAndVaried) {
  for (const Target& board :
       {chessboardTarget(9, 6, 0.03), aprilgridTarget("tag36h11", 4, 3, 0.05, 0.3, 0), charucoTarget(6, 5, 0.04, 0.03, "DICT_4X4_50")}) {
    const std::vector<Eigen::Isometry3d> poses = drawBoardPoses(pinhole(), board, 20, 3);
    ASSERT_EQ(poses.size(), 20u);
    double steepest = 1.0;
    Eigen::AlignedBox2d seen;
    for (const Eigen::Isometry3d& T_camera_target : poses) {
      for (const FaceSight& sight : sightOf(pinhole(), board, T_camera_target)) {
        EXPECT_TRUE(sight.complete);
        EXPECT_TRUE(inPicture(pinhole(), sight.corners, 0.0));
        EXPECT_GT(sight.facing_cos, 0.5);
        steepest = std::min(steepest, sight.facing_cos);
        for (const Corner& corner : sight.corners) seen.extend(corner.px);
      }
    }
    EXPECT_LT(steepest, std::cos(0.35)) << "some are tilted by 20 degrees or more: else the focal length cannot be seen";
    EXPECT_GT(seen.sizes().x(), 0.8 * 640) << "together they reach across the picture";
    EXPECT_GT(seen.sizes().y(), 0.8 * 480);
  }
}

}  // namespace
}  // namespace poecal
