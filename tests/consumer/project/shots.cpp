#include "shots.hpp"

#include <cmath>
#include <random>

#include <poecal/cell/cell.hpp>

namespace {

/// The arm as it is: axes a little off, and the elbow seen from 0.5 mrad to either side.
poecal::Cell trueCell() {
  poecal::Cell cell;
  cell.arm.emplace();
  cell.arm->joints = {poecal::Joint::revolute("base", Eigen::Vector3d(0.001, -0.002, 1.0).normalized(), {0.0004, 0.0, 0.0}),
                      poecal::Joint::revolute("shoulder", Eigen::Vector3d(0.001, 1.0, 0.001).normalized(), {0.0503, 0.0, 0.3496}),
                      poecal::Joint::revolute("elbow", Eigen::Vector3d(-0.002, 1.0, 0.0).normalized(), {0.0497, 0.0, 0.7505})};
  cell.arm->gamma << 0.0, 0.0, 0.0, 0.45, 0.0, 0.8;
  cell.camera = plainCamera();
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();  // looks along -x of base, from 1.8 m before it
  T_base_camera.linear() << 0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  T_base_camera.translation() << 1.8, 0.0, 0.75;
  cell.registration.T_camera_near = T_base_camera.inverse();
  cell.registration.T_far_target.linear() = T_base_camera.linear();
  cell.registration.T_far_target.translation() << 0.02, 0.01, -0.01;
  return cell;
}

}  // namespace

poecal::Camera plainCamera() {
  poecal::Camera camera;
  camera.width = 2448;
  camera.height = 2048;
  camera.fx = camera.fy = 2400.0;
  camera.cx = 1224.0;
  camera.cy = 1024.0;
  camera.distortion = Eigen::VectorXd::Zero(5);
  return camera;
}

std::vector<Shot> takeShots(const poecal::Target& target) {
  const poecal::Cell cell = trueCell();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(-0.6, 0.6);
  std::bernoulli_distribution side(0.5);
  std::normal_distribution<double> noise(0.0, 0.05);  // [px]
  std::vector<Shot> shots;
  for (int k = 0; k < 60; ++k) {
    Shot shot;
    shot.q = Eigen::Vector3d(angle(random), 0.5 * angle(random), angle(random));
    shot.dir = Eigen::Vector3d::NullaryExpr([&] { return side(random) ? 1.0 : -1.0; });
    const Eigen::Vector3d really = shot.q + Eigen::Vector3d(0.0, 0.0, 5e-4 * shot.dir(2));
    shot.corners = poecal::predictCorners(cell, target, poecal::forwardKinematics(*cell.arm, really));
    for (poecal::Corner& corner : shot.corners) corner.px += Eigen::Vector2d(noise(random), noise(random));
    shots.push_back(shot);
  }
  return shots;
}
