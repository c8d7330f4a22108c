// Pictures of a flat board as a known camera sees them.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "poecal/camera/intrinsics.hpp"
#include "poecal/geometry/se3.hpp"
#include "support/random.hpp"

namespace poecal::test {

struct BoardScene {
  std::vector<BoardView> views;
  std::vector<Eigen::Isometry3d> T_camera_target;
};

/// 7 x 5 points 35 mm apart in the plane z = 0, about their centre.
inline Eigen::Matrix3Xd boardPoints() {
  Eigen::Matrix3Xd points(3, 35);
  for (int k = 0; k < 35; ++k) points.col(k) << 0.035 * (k % 7 - 3), 0.035 * (k / 7 - 2), 0.0;
  return points;
}

/// `count` pictures without noise: the board about 0.35 m away, tilted by up to `tilt` about both axes, anywhere that the whole of it is
/// in the picture.
inline BoardScene boardScene(const Camera& camera, int count, Rng& rng, double tilt = 0.6) {
  const Eigen::Matrix3Xd points = boardPoints();
  BoardScene scene;
  for (int attempt = 0; static_cast<int>(scene.views.size()) < count; ++attempt) {
    if (attempt > 1000 * count) {
      ADD_FAILURE() << "no room for the board in this camera's picture";
      break;
    }
    const double depth = rng.uniform(0.2, 0.5);
    Vector6d pose;
    pose << rng.uniform(-tilt, tilt), rng.uniform(-tilt, tilt), rng.uniform(-0.5, 0.5), depth * rng.uniform(-0.8, 0.8),
        depth * rng.uniform(-0.7, 0.7), depth;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = expSo3({pose(0), pose(1), 0.0}) * expSo3({0.0, 0.0, pose(2)});
    T.translation() = pose.tail<3>();
    BoardView view{"view-" + std::to_string(scene.views.size()), points, Eigen::Matrix2Xd(2, points.cols())};
    bool whole = true;
    for (Eigen::Index i = 0; i < points.cols() && whole; ++i) {
      const auto px = project(camera, T * points.col(i));
      whole = px && px->x() > 0.0 && px->y() > 0.0 && px->x() < camera.width - 1 && px->y() < camera.height - 1;
      if (whole) view.pixels.col(i) = *px;
    }
    if (!whole) continue;
    scene.views.push_back(view);
    scene.T_camera_target.push_back(T);
  }
  return scene;
}

/// The same pictures with normal noise on every coordinate.
inline std::vector<BoardView> noisy(std::vector<BoardView> views, double sigma_px, Rng& rng) {
  for (BoardView& view : views) {
    for (Eigen::Index k = 0; k < view.pixels.size(); ++k) view.pixels(k) += sigma_px * rng.normal();
  }
  return views;
}

}  // namespace poecal::test
