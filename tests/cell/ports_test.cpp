#include "poecal/cell/ports.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "support/arms.hpp"
#include "support/cameras.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::IsNear;
using test::PoseIsNear;

/// Central differences of pixels of some hundred px: rounding 1e-13 * 500 / 1e-6, truncation far below.
constexpr double kStep = 1e-6;
constexpr double kPixelTolerance = 2e-5;
constexpr double kRounding = 1e-13;

/// A cell whose target is about 2 m before the camera at every sample, and one sample of it.
struct Example {
  Cell cell;
  Sample sample;
  std::vector<TargetPoint> points;
};

Example makeExample(Rng& rng, Setup setup) {
  Example example;
  example.cell.arm = test::randomArm(rng, "RRPR");
  example.cell.camera = test::plumbBob(640, 480, {500.0, 510.0}, {320.0, 240.0}, {-0.08, 0.05, 1e-3, -7e-4, 0.01});
  example.sample.q = test::uniformVector(rng, 4, 0.5);
  Registration& registration = example.cell.registration;
  registration.setup = setup;
  registration.T_far_target = test::randomPose(rng, 1.0, 0.2);
  Eigen::Isometry3d T_camera_target = test::randomPose(rng, 0.4, 0.1);
  T_camera_target.translation().z() += 2.0;
  registration.T_camera_near = Eigen::Isometry3d::Identity();
  registration.T_camera_near =
      T_camera_target * registration.cameraTarget(forwardKinematics(*example.cell.arm, example.sample.q)).inverse();
  for (int corner = 0; corner < 3; ++corner) example.points.push_back({{1, corner}, test::uniformVector(rng, 3, 0.2)});
  return example;
}

/// Small random values at every port.
Disturbance randomDisturbance(Rng& rng, const Example& example, double size) {
  Disturbance disturbance = Disturbance::zero(example.cell, example.points.size());
  disturbance.joints = test::uniformVector(rng, 4, size);
  for (Vector6d& link : disturbance.links) link = test::uniformVector(rng, 6, size);
  disturbance.base = test::uniformVector(rng, 6, size);
  disturbance.mount = test::uniformVector(rng, 6, size);
  disturbance.grip = test::uniformVector(rng, 6, size);
  disturbance.intrinsics = test::uniformVector(rng, 9, size);
  for (Eigen::Vector3d& point : disturbance.points) point = test::uniformVector(rng, 3, size);
  for (Eigen::Vector2d& pixel : disturbance.pixels) pixel = test::uniformVector(rng, 2, size);
  return disturbance;
}

/// Every number of a disturbance, so that a test can step through the ports one by one.
std::vector<double*> entriesOf(Disturbance& disturbance) {
  std::vector<double*> entries;
  const auto add = [&entries](auto& vector) {
    for (double& entry : vector) entries.push_back(&entry);
  };
  add(disturbance.joints);
  for (Vector6d& link : disturbance.links) add(link);
  add(disturbance.base);
  add(disturbance.mount);
  add(disturbance.grip);
  add(disturbance.intrinsics);
  for (Eigen::Vector3d& point : disturbance.points) add(point);
  for (Eigen::Vector2d& pixel : disturbance.pixels) add(pixel);
  return entries;
}

Eigen::VectorXd pixelsOf(const Example& example, const Disturbance& disturbance) {
  const auto corners = disturbedCorners(example.cell, example.sample, example.points, disturbance);
  Eigen::VectorXd pixels(2 * static_cast<Eigen::Index>(corners.size()));
  for (std::size_t j = 0; j < corners.size(); ++j) pixels.segment<2>(2 * static_cast<Eigen::Index>(j)) = corners[j].value();
  return pixels;
}

class Ports : public ::testing::TestWithParam<Setup> {};

TEST_P(Ports, NoDisturbanceHasTheBitsOfTheUndisturbedCell) {
  Rng rng = test::rngOfThisTest();
  const Example example = makeExample(rng, GetParam());
  const Eigen::Isometry3d T_base_flange = example.cell.baseFlange(example.sample);
  Target target;
  target.points = example.points;
  const std::vector<Corner> expected = predictCorners(example.cell, target, T_base_flange);
  ASSERT_EQ(expected.size(), example.points.size());
  for (const Disturbance& none : {Disturbance{}, Disturbance::zero(example.cell, example.points.size())}) {
    EXPECT_THAT(disturbedFlange(example.cell, example.sample, none), PoseIsNear(T_base_flange, 0.0));
    const auto corners = disturbedCorners(example.cell, example.sample, example.points, none);
    for (std::size_t j = 0; j < corners.size(); ++j) EXPECT_EQ(corners[j].value(), expected[j].px);
  }
}

TEST_P(Ports, EveryPortMovesThePixelsAsItsDerivativeSays) {
  Rng rng = test::rngOfThisTest();
  for (const double size : {0.0, 0.02}) {
    const Example example = makeExample(rng, GetParam());
    const Disturbance at = randomDisturbance(rng, example, size);
    const PortJacobian jacobian = portJacobian(example.cell, example.sample, example.points, at);
    Disturbance direction = Disturbance::zero(example.cell, example.points.size());
    Disturbance plus = at, minus = at;
    const auto directions = entriesOf(direction), forward = entriesOf(plus), back = entriesOf(minus);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const double value = *forward[k];
      *directions[k] = 1.0;
      *forward[k] = value + kStep;
      *back[k] = value - kStep;
      const Eigen::VectorXd difference = (pixelsOf(example, plus) - pixelsOf(example, minus)) / (2.0 * kStep);
      EXPECT_THAT(jacobian.along(direction), IsNear(difference, kPixelTolerance)) << "entry " << k << " at disturbances of " << size;
      *directions[k] = 0.0;
      *forward[k] = *back[k] = value;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothSetups, Ports, ::testing::Values(Setup::kEyeToHand, Setup::kEyeInHand),
                         [](const auto& parameter) { return std::string(setupName(parameter.param)); });

TEST(DisturbedFlange, LinkTwistIsAChangedArm) {
  // Second formula: what body 2 of three is twisted by at its end displaces joint 3 and the flange of an arm that is otherwise the same.
  Rng rng = test::rngOfThisTest();
  Example example = makeExample(rng, Setup::kEyeToHand);
  example.cell.arm = test::randomArm(rng, "RPR");
  example.sample.q = test::uniformVector(rng, 3, 1.0);
  Disturbance disturbance = Disturbance::zero(example.cell, 0);
  disturbance.links[1] = test::uniformVector(rng, 6, 0.3);
  const Eigen::Isometry3d T_twist = expSe3(disturbance.links[1]);
  Arm bent = *example.cell.arm;
  bent.joints[2].xi = adjoint(T_twist) * bent.joints[2].xi;
  bent.gamma = logSe3(T_twist * expSe3(bent.gamma));
  EXPECT_THAT(disturbedFlange(example.cell, example.sample, disturbance), PoseIsNear(forwardKinematics(bent, example.sample.q), kRounding));
}

TEST(DisturbedFlange, JointOffsetIsAnotherReading) {
  Rng rng = test::rngOfThisTest();
  const Example example = makeExample(rng, Setup::kEyeToHand);
  Disturbance disturbance;
  disturbance.joints = test::uniformVector(rng, 4, 0.3);
  Sample read_right = example.sample;
  read_right.q += disturbance.joints;
  EXPECT_THAT(disturbedFlange(example.cell, example.sample, disturbance), PoseIsNear(example.cell.baseFlange(read_right), kRounding));
}

TEST(DisturbedFlange, ControllersPoseMovesWithTheBase) {
  Sample sample;
  sample.T_base_flange = Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0));
  Disturbance disturbance;
  disturbance.base << 0, 0, M_PI / 2, 0, 0, 0;
  EXPECT_THAT(Eigen::Vector3d(disturbedFlange(Cell{}, sample, disturbance).translation()), IsNear(Eigen::Vector3d(0, 1, 0), kRounding));
  disturbance.joints = Eigen::VectorXd::Zero(2);
  EXPECT_THROW(disturbedFlange(Cell{}, sample, disturbance), InvalidArgument) << "joints of an arm that is not there";
}

TEST(DisturbedCorners, WrongLengthsAreNamed) {
  Rng rng = test::rngOfThisTest();
  const Example example = makeExample(rng, Setup::kEyeToHand);
  Disturbance disturbance;
  disturbance.pixels.resize(7, Eigen::Vector2d::Zero());
  EXPECT_THROW(
      try { disturbedCorners(example.cell, example.sample, example.points, disturbance); } catch (const InvalidArgument& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("7 values for the pixels, expected 3"));
        throw;
      },
      InvalidArgument);
}

}  // namespace
}  // namespace poecal
