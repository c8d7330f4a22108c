#include "planning/clearance.hpp"

#include <numbers>

#include <gmock/gmock.h>

#include "support/random.hpp"

namespace poecal {
namespace {

// Two links of 1 m in the xz plane, turning about y: up to the elbow, then along x to the flange.
Cell twoLinks() {
  Cell cell;
  Arm& arm = cell.arm.emplace();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  arm.joints = {Joint::revolute("shoulder", y, {0, 0, 0}), Joint::revolute("elbow", y, {0, 0, 1})};
  arm.gamma << 0, 0, 0, 1, 0, 1;
  return cell;
}

/// The camera at a point of base.
Cell withCameraAt(const Eigen::Vector3d& p_base) {
  Cell cell = twoLinks();
  cell.registration.T_camera_near = Eigen::Isometry3d(Eigen::Translation3d(p_base)).inverse();
  return cell;
}

PlanOptions thin() {
  PlanOptions options;
  options.link_radius = 0.05;
  options.camera_radius = 0.1;
  return options;
}

const Eigen::Vector3d kGravity(0, 0, -9.8);

bool isFree(const Cell& cell, double shoulder, double elbow, const PlanOptions& options = thin()) {
  return Clearance(cell, kGravity, options).isFree(Eigen::Vector2d(shoulder, elbow));
}

TEST(SegmentDistance, OfKnownSegments) {
  const Eigen::Vector3d o = Eigen::Vector3d::Zero(), x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(segmentDistance(-x, x, z - y, z + y), 1.0, kRounding);     // crossing above each other
  EXPECT_NEAR(segmentDistance(o, x, y, x + y), 1.0, kRounding);          // parallel
  EXPECT_NEAR(segmentDistance(o, x, 3.0 * x, 4.0 * x), 2.0, kRounding);  // behind each other
  EXPECT_NEAR(segmentDistance(o, x, 2.0 * y, 2.0 * y), 2.0, kRounding);  // a point
  EXPECT_NEAR(segmentDistance(2.0 * y, 2.0 * y, o, x), 2.0, kRounding);  // likewise
  EXPECT_NEAR(segmentDistance(o, o, 2.0 * y + z, 2.0 * y + z), std::sqrt(5.0), kRounding);
}

// A second formula: the least over a grid of points of both.
TEST(SegmentDistance, IsTheLeastOverAllPoints) {
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Eigen::Vector3d> p;
    for (int k = 0; k < 4; ++k) p.push_back(test::uniformVector(rng, 3, 1.0));
    constexpr int kSteps = 200;
    double least = 10.0;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        const double s = static_cast<double>(i) / kSteps, t = static_cast<double>(j) / kSteps;
        least = std::min(least, (p[0] + s * (p[1] - p[0]) - p[2] - t * (p[3] - p[2])).norm());
      }
    }
    const double distance = segmentDistance(p[0], p[1], p[2], p[3]);
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - 0.02);  // half a step of each, of segments up to 2 sqrt(3) m
  }
}

TEST(Clearance, LinksStayOffTheCamera) {
  EXPECT_TRUE(isFree(withCameraAt({0, 0, 2}), 0, 0));
  EXPECT_FALSE(isFree(withCameraAt({0.5, 0, 1.12}), 0, 0));  // 12 cm above a link of 5 cm, the camera has 10 cm
  EXPECT_TRUE(isFree(withCameraAt({0.5, 0, 1.18}), 0, 0));
}

TEST(Clearance, NoLinkStandsBetweenCameraAndTarget) {
  // The flange is at (1, 0, 1); a camera behind the upper arm looks through it, one before it does not.
  EXPECT_FALSE(isFree(withCameraAt({-1, 0, 0.5}), 0, 0));
  EXPECT_TRUE(isFree(withCameraAt({3, 0, 0.5}), 0, 0));
}

TEST(Clearance, FloorIsWhereItIsStatedTo) {
  const double down = 0.5 * std::numbers::pi + 0.3;  // the upper arm dips below base
  const Cell cell = withCameraAt({0, 3, 0});
  EXPECT_TRUE(isFree(cell, down, -0.6));
  PlanOptions floor = thin();
  floor.floor = 0.0;
  EXPECT_FALSE(isFree(cell, down, -0.6, floor));
  EXPECT_TRUE(isFree(cell, 0.0, 0.0, floor));
}

TEST(Clearance, LinkRadiusIsAShareOfTheLength) {
  EXPECT_NEAR(Clearance(withCameraAt({0, 3, 0}), kGravity, {}).linkRadius(), 0.04 * 2.0, 1e-12);
}

}  // namespace
}  // namespace poecal
