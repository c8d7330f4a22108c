// A program of somebody else that uses the installed library: it says whether what it gets is what it computed by hand, and calls into
// each part of poecal that needs a library of its own, so that one that is missing at the link shows here.
#include <cmath>
#include <filesystem>
#include <numbers>

#include <poecal/camera/camera.hpp>
#include <poecal/core/error.hpp>
#include <poecal/core/text.hpp>
#include <poecal/detection/detector.hpp>
#include <poecal/identification/identify.hpp>
#include <poecal/robot/arm.hpp>
#include <poecal/robot/robot_file.hpp>

namespace {

constexpr double kRounding = 1e-12;

/// A turntable whose flange stands 0.3 m along x.
poecal::Arm turntable() {
  poecal::Arm arm;
  arm.joints.push_back(poecal::Joint::revolute("turn", Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()));
  arm.gamma(3) = 0.3;
  return arm;
}

/// After a quarter turn the flange stands 0.3 m along y.
bool forwardKinematicsIsRight(const Eigen::Isometry3d& T_base_flange) {
  return (T_base_flange.translation() - Eigen::Vector3d(0.0, 0.3, 0.0)).norm() <= kRounding;
}

/// The flange before a camera 2 m away, read from its file: (100 * 0 / 2 + 50, 100 * 0.3 / 2 + 40).
bool projectionIsRight(const Eigen::Vector3d& p_base) {
  poecal::Camera camera;
  camera.width = camera.height = 100;
  camera.fx = camera.fy = 100.0;
  camera.cx = 50.0;
  camera.cy = 40.0;
  camera.distortion = Eigen::VectorXd::Zero(5);
  poecal::writeTextFile("camera.yaml", poecal::cameraYaml(camera));
  const auto px = poecal::project(poecal::readCamera("camera.yaml"), p_base + Eigen::Vector3d(0.0, 0.0, 2.0));
  return px && (*px - Eigen::Vector2d(50.0, 55.0)).norm() <= kRounding;
}

template <typename Failure, typename Call>
bool fails(const Call& call) {
  try {
    call();
    return false;
  } catch (const Failure&) {
    return true;
  }
}

bool everyLibraryIsLinked() {
  const poecal::Target tag = poecal::apriltagTarget("tag36h11", {{.id = 0, .size = 0.1}});
  return fails<poecal::FileError>([] { poecal::readUrdf("missing.urdf", "base", "tip"); }) &&
         fails<poecal::InsufficientData>([] { poecal::identify({.arm = turntable()}, {}); }) &&
         poecal::detect(".", {"missing.png"}, tag, {}).notes.at(0).failed;
}

}  // namespace

int main() {
  const Eigen::VectorXd quarter_turn = Eigen::VectorXd::Constant(1, std::numbers::pi / 2.0);
  const Eigen::Isometry3d T_base_flange = poecal::forwardKinematics(turntable(), quarter_turn);
  if (!forwardKinematicsIsRight(T_base_flange)) return 1;
  if (!projectionIsRight(T_base_flange.translation())) return 2;
  return everyLibraryIsLinked() ? 0 : 3;
}
