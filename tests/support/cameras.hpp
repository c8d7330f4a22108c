// Cameras as tests need them.
#pragma once

#include <algorithm>
#include <initializer_list>

#include "poecal/camera/camera.hpp"

namespace poecal::test {

/// A plumb bob lens.
/// @param focal  fx, fy [px]. @param centre  cx, cy [px]. @param distortion  k1, k2, p1, p2, k3; those left out are zero.
inline Camera plumbBob(int width, int height, const Eigen::Vector2d& focal, const Eigen::Vector2d& centre,
                       std::initializer_list<double> distortion = {}) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focal.x();
  camera.fy = focal.y();
  camera.cx = centre.x();
  camera.cy = centre.y();
  camera.distortion = Eigen::VectorXd::Zero(5);
  std::copy(distortion.begin(), distortion.end(), camera.distortion.data());
  return camera;
}

}  // namespace poecal::test
