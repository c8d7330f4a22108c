#include "poecal/cell/cell.hpp"

#include <gmock/gmock.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "poecal/core/error.hpp"
#include "support/cameras.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using test::IsNear;
using test::PoseIsNear;

// A handful of products of poses with entries of a few metres: rounding stays well below this.
constexpr double kRounding = 1e-13;

Registration randomRegistration(Rng& rng, Setup setup) {
  return {.setup = setup, .T_camera_near = test::randomPose(rng), .T_far_target = test::randomPose(rng)};
}

Camera pinhole() { return test::plumbBob(640, 480, {500.0, 510.0}, {320.0, 240.0}); }

Target oneTag(double size) { return apriltagTarget("tag36h11", {{.id = 7, .size = size}}); }

TEST(Registration, EyeToHandIsTheChainOfTheContract) {
  Rng rng = test::rngOfThisTest();
  const Registration registration = randomRegistration(rng, Setup::kEyeToHand);
  const Eigen::Isometry3d T_base_flange = test::randomPose(rng);
  const Eigen::Matrix4d T_camera_target = registration.T_camera_near.matrix() * T_base_flange.matrix() * registration.T_far_target.matrix();
  EXPECT_THAT(Eigen::Matrix4d(registration.cameraTarget(T_base_flange).matrix()), IsNear(T_camera_target, kRounding));
  EXPECT_THAT(registration.cameraBase(T_base_flange), PoseIsNear(registration.T_camera_near, 0.0));
  EXPECT_STREQ(registration.nearFrame(), "base");
  EXPECT_STREQ(registration.farFrame(), "flange");
}

TEST(Registration, EyeInHandCarriesPointsByWayOfTheBase) {
  // Second formula: no inverse of a product, but each point is taken from target to base, and the camera's place in base is found by
  // itself.
  Rng rng = test::rngOfThisTest();
  const Registration registration = randomRegistration(rng, Setup::kEyeInHand);
  const Eigen::Isometry3d T_base_flange = test::randomPose(rng);
  const Eigen::Matrix4d T_flange_camera = registration.T_camera_near.matrix().inverse();
  const Eigen::Matrix4d T_base_camera = T_base_flange.matrix() * T_flange_camera;
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::Vector3d p_target = test::uniformVector(rng, 3, 1.0);
    const Eigen::Vector4d p_base = registration.T_far_target.matrix() * p_target.homogeneous();
    const Eigen::Vector4d p_camera = T_base_camera.fullPivLu().solve(p_base);
    EXPECT_THAT(Eigen::Vector3d(registration.cameraTarget(T_base_flange) * p_target),
                IsNear(Eigen::Vector3d(p_camera.head<3>()), kRounding));
  }
  EXPECT_THAT(Eigen::Matrix4d(registration.cameraBase(T_base_flange).matrix()),
              IsNear(Eigen::Matrix4d(T_base_camera.inverse()), kRounding));
  EXPECT_STREQ(registration.nearFrame(), "flange");
  EXPECT_STREQ(registration.farFrame(), "base");
}

TEST(Registration, BaseFlangeUndoesCameraTarget) {
  Rng rng = test::rngOfThisTest();
  for (const poecal::Setup setup : {Setup::kEyeToHand, Setup::kEyeInHand}) {
    const Registration registration = randomRegistration(rng, setup);
    const Eigen::Isometry3d T_base_flange = test::randomPose(rng);
    EXPECT_THAT(registration.baseFlange(registration.cameraTarget(T_base_flange)), PoseIsNear(T_base_flange, kRounding));
  }
}

TEST(Cell, FlangePoseComesFromTheArmBeforeTheController) {
  // One joint that turns about z, the flange 1 m out along x: at a quarter turn it is at (0, 1, 0).
  Arm arm;
  arm.joints = {Joint::revolute("joint_1", Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero())};
  arm.gamma << 0, 0, 0, 1, 0, 0;
  Sample sample;
  sample.q = Eigen::VectorXd::Constant(1, M_PI / 2);
  sample.T_base_flange = Eigen::Isometry3d(Eigen::Translation3d(5, 5, 5));
  const Cell with_arm{.arm = arm, .camera = std::nullopt, .registration = {}};
  EXPECT_THAT(Eigen::Vector3d(with_arm.baseFlange(sample).translation()), IsNear(Eigen::Vector3d(0, 1, 0), kRounding));
  EXPECT_THAT(Cell{}.baseFlange(sample), PoseIsNear(*sample.T_base_flange, 0.0));
}

TEST(Cell, SampleWithoutAnyPoseIsAnError) {
  Sample sample;
  sample.image = "images/0007.png";
  EXPECT_THROW(
      try { Cell{}.baseFlange(sample); } catch (const InvalidArgument& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("images/0007.png"));
        throw;
      },
      InvalidArgument);
}

TEST(PredictCorners, TagStraightAheadByHand) {
  // A 0.2 m tag 2 m ahead, upright: corners at +-0.1 m, so +-25 px across and +-25.5 px down from the middle; 0 is bottom-left.
  Cell cell;
  cell.camera = pinhole();
  cell.registration.T_far_target = Eigen::Isometry3d(Eigen::Translation3d(0, 0, 2));
  const std::vector<Corner> corners = predictCorners(cell, oneTag(0.2), Eigen::Isometry3d::Identity());
  ASSERT_EQ(corners.size(), 4u);
  const Eigen::Vector2d expected[] = {{295, 265.5}, {345, 265.5}, {345, 214.5}, {295, 214.5}};
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(corners[static_cast<std::size_t>(k)].id, (PointId{7, k}));
    EXPECT_THAT(corners[static_cast<std::size_t>(k)].px, IsNear(expected[k], 1e-10));
  }
}

TEST(PredictCorners, PointsBehindTheCameraAreLeftOut) {
  // Turned by 90 degrees about y, x of the tag points away from the camera (or to it): half of the tag is behind.
  Cell cell;
  cell.camera = pinhole();
  cell.registration.T_far_target = expSe3((Vector6d() << 0, M_PI / 2, 0, 0, 0, 0).finished());
  const std::vector<Corner> corners = predictCorners(cell, oneTag(0.2), Eigen::Isometry3d::Identity());
  ASSERT_EQ(corners.size(), 2u);
  EXPECT_EQ(corners[0].id.corner, 0);
  EXPECT_EQ(corners[1].id.corner, 3);
}

TEST(PredictCorners, CellWithoutCameraIsAnError) {
  EXPECT_THROW(predictCorners(Cell{}, oneTag(0.2), Eigen::Isometry3d::Identity()), InvalidArgument);
}

}  // namespace
}  // namespace poecal
