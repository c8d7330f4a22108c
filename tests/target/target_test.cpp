#include "poecal/target/target.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/geometry/se3.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

constexpr double kRounding = 1e-15;  // coordinates are below 1 m

auto refused(const std::string& message) { return Throws<InvalidArgument>(Property(&InvalidArgument::what, HasSubstr(message))); }

Eigen::Vector3d pointOf(const Target& target, int tag, int corner) {
  const TargetPoint* point = target.find({tag, corner});
  return point != nullptr ? point->p_target : Eigen::Vector3d::Constant(NAN);
}

TEST(Target, CornersOfATagRunFromBottomLeftToTopLeftWithYDown) {
  const Target target = apriltagTarget("tag36h11", {{7, 0.08, Eigen::Isometry3d::Identity()}});
  EXPECT_THAT(pointOf(target, 7, 0), test::IsNear(Eigen::Vector3d(-0.04, 0.04, 0), kRounding));
  EXPECT_THAT(pointOf(target, 7, 1), test::IsNear(Eigen::Vector3d(0.04, 0.04, 0), kRounding));
  EXPECT_THAT(pointOf(target, 7, 2), test::IsNear(Eigen::Vector3d(0.04, -0.04, 0), kRounding));
  EXPECT_THAT(pointOf(target, 7, 3), test::IsNear(Eigen::Vector3d(-0.04, -0.04, 0), kRounding));
  EXPECT_EQ(target.find({7, 4}), nullptr);
  EXPECT_EQ(target.find({8, 0}), nullptr);
}

TEST(Target, AprilgridGrowsRightAndUpFromCornerZeroOfItsFirstTag) {
  const Target target = aprilgridTarget("tag36h11", 3, 2, 0.10, 0.3, 5);
  ASSERT_EQ(target.tags.size(), 6u);
  EXPECT_THAT(pointOf(target, 5, 0), test::IsNear(Eigen::Vector3d(0, 0, 0), kRounding));
  EXPECT_THAT(pointOf(target, 5, 1), test::IsNear(Eigen::Vector3d(0.10, 0, 0), kRounding));
  EXPECT_THAT(pointOf(target, 5, 2), test::IsNear(Eigen::Vector3d(0.10, 0.10, 0), kRounding));
  EXPECT_THAT(pointOf(target, 5, 3), test::IsNear(Eigen::Vector3d(0, 0.10, 0), kRounding));
  // One pitch is 0.10 (1 + 0.3); the second row starts with id 5 + 3.
  EXPECT_THAT(pointOf(target, 7, 0), test::IsNear(Eigen::Vector3d(0.26, 0, 0), kRounding));
  EXPECT_THAT(pointOf(target, 8, 0), test::IsNear(Eigen::Vector3d(0, 0.13, 0), kRounding));
  for (const TargetTag& tag : target.tags) EXPECT_GT(tag.T_target_tag.linear().determinant(), 0.0);
}

TEST(Target, BoardsCountRowByRow) {
  const Target chessboard = chessboardTarget(9, 6, 0.025);
  EXPECT_EQ(chessboard.points.size(), 54u);
  EXPECT_THAT(pointOf(chessboard, -1, 0), test::IsNear(Eigen::Vector3d(0, 0, 0), kRounding));
  EXPECT_THAT(pointOf(chessboard, -1, 9 * 2 + 4), test::IsNear(Eigen::Vector3d(0.100, 0.050, 0), kRounding));
  const Target charuco = charucoTarget(5, 7, 0.04, 0.02, "DICT_6X6_250");
  EXPECT_EQ(charuco.points.size(), 24u);
  EXPECT_THAT(pointOf(charuco, -1, 0), test::IsNear(Eigen::Vector3d(0.04, 0.04, 0), kRounding));
  EXPECT_THAT(pointOf(charuco, -1, 4 * 5 + 3), test::IsNear(Eigen::Vector3d(0.16, 0.24, 0), kRounding));
}

TEST(Target, PointsAreSortedByName) {
  const Target target = pointsTarget({{{9, 0}, {1, 0, 0}}, {{2, 3}, {0, 1, 0}}});
  EXPECT_EQ(target.points.front().id, (PointId{2, 0}));
  EXPECT_THAT(pointOf(target, 9, 0), test::IsNear(Eigen::Vector3d(1, 0, 0), 0.0));
}

TEST(Target, PlanarWhateverTheAttitudeAndNotByTwoNanometres) {
  Rng rng = test::rngOfThisTest();
  const Eigen::Isometry3d T = test::randomPose(rng);
  std::vector<TargetPoint> points = chessboardTarget(4, 3, 0.1).points;
  for (std::size_t k = 0; k < points.size(); ++k) points[k] = {{static_cast<int>(k), 0}, T * points[k].p_target};
  EXPECT_TRUE(pointsTarget(points).planar());
  // The plane follows a raised corner in part, so it is raised well beyond the limit of 1e-9 m.
  points[0].p_target += T.linear().col(2) * 1e-8;
  EXPECT_FALSE(pointsTarget(points).planar());
  const TargetTag front{1, 0.05, Eigen::Isometry3d::Identity()};
  TargetTag side{2, 0.05, Eigen::Isometry3d::Identity()};
  side.T_target_tag = poseFromQuaternion({0.03, 0, 0.03}, {0, 1, 0, 1});
  EXPECT_TRUE(apriltagTarget("tag36h11", {front}).planar());
  EXPECT_FALSE(apriltagTarget("tag36h11", {front, side}).planar());
}

TEST(Target, ImpossibleTargetsAreRefused) {
  const Eigen::Isometry3d I = Eigen::Isometry3d::Identity();
  EXPECT_THAT([&] { apriltagTarget("tag36h1", {{1, 0.1, I}}); }, refused("tag family 'tag36h1' is not known, expected one of: tag36h11,"));
  EXPECT_THAT([&] { apriltagTarget("tag36h11", {}); }, refused("without tags"));
  EXPECT_THAT([&] { apriltagTarget("tag36h11", {{1, 0.1, I}, {1, 0.2, I}}); }, refused("tag id 1 is there twice"));
  EXPECT_THAT([&] { apriltagTarget("tag36h11", {{1, 0.0, I}}); }, refused("size of a tag is 0, expected a positive length"));
  EXPECT_THAT([&] { apriltagTarget("tag36h11", {{1, NAN, I}}); }, refused("size of a tag is nan"));
  EXPECT_THAT([&] { apriltagTarget("tag36h11", {{1, 80.0, I}}); }, refused("size of a tag is 80 m, expected at most 3 m: millimetres?"));
  EXPECT_THAT([&] { chessboardTarget(9, 6, 30.0); }, refused("square is 30 m, expected at most 3 m"));
  EXPECT_THAT([&] { apriltagTarget("tag36h11", {{587, 0.1, I}}); }, refused("tag id 587 does not exist, tag36h11 has ids 0 to 586"));
  EXPECT_THAT([&] { aprilgridTarget("tag16h5", 6, 6, 0.1, 0.3, 0); }, refused("tag id 35 does not exist"));
  EXPECT_THAT([&] { aprilgridTarget("tag36h11", 6, 6, 0.1, 0.0, 0); }, refused("tagSpacing is 0"));
  EXPECT_THAT([&] { charucoTarget(5, 7, 0.02, 0.02, "DICT_6X6_250"); }, refused("expected less than square"));
  EXPECT_THAT([&] { charucoTarget(11, 10, 0.02, 0.01, "DICT_6X6_50"); }, refused("has 55 markers, DICT_6X6_50 only 50"));
  EXPECT_THAT([&] { chessboardTarget(2, 6, 0.1); }, refused("cols is 2, expected 3 to 1000"));
  EXPECT_THAT([&] { pointsTarget({{{1, 0}, {}}, {{1, 1}, {}}}); }, refused("point id 1 is there twice"));
}

}  // namespace
}  // namespace poecal
