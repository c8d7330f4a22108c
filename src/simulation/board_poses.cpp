#include "simulation/board_poses.hpp"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "cell/sight.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/random.hpp"
#include "poecal/geometry/se3.hpp"
#include "simulation/streams.hpp"

namespace poecal {
namespace {

constexpr int kDrawsOfPose = 1000;
constexpr double kSmallestSize = 0.35, kLargestSize = 0.9;  ///< of the picture's height
constexpr double kTilt = 35.0 * std::numbers::pi / 180.0;
constexpr double kRoll = 20.0 * std::numbers::pi / 180.0;
constexpr double kMargin = 0.02;

/// The middle of the board, turned so that x is right, y down and z into it seen from its front.
Eigen::Isometry3d boardMiddle(const Target& board) {
  Eigen::AlignedBox3d bounds;
  for (const TargetPoint& point : board.points) bounds.extend(point.p_target);
  Eigen::Isometry3d T_target_middle(Eigen::Translation3d(bounds.center()));
  if (!board.tags.empty()) T_target_middle.linear() = board.tags.front().T_target_tag.linear();
  return T_target_middle;
}

double largestExtent(const Target& board) {
  Eigen::AlignedBox3d bounds;
  for (const TargetPoint& point : board.points) bounds.extend(point.p_target);
  return bounds.sizes().maxCoeff();
}

}  // namespace

std::vector<Eigen::Isometry3d> drawBoardPoses(const Camera& camera, const Target& board, int count, std::uint64_t seed) {
  const Eigen::Isometry3d T_middle_target = boardMiddle(board).inverse();
  const double extent = largestExtent(board);
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < count; ++k) {
    Rng rng(seed, streamOf(Purpose::kBoardPose, static_cast<std::size_t>(k)));
    for (int draw = 0; draw < kDrawsOfPose; ++draw) {
      const double tilt_x = rng.uniform(-kTilt, kTilt), tilt_y = rng.uniform(-kTilt, kTilt), roll = rng.uniform(-kRoll, kRoll);
      const double depth = camera.fy * extent / (rng.uniform(kSmallestSize, kLargestSize) * camera.height);
      const double u = rng.uniform(0.0, camera.width), v = rng.uniform(0.0, camera.height);
      const std::optional<Eigen::Vector3d> ray = unproject(camera, {u, v});
      if (!ray) continue;
      Eigen::Isometry3d T_camera_middle(Eigen::Translation3d(*ray * (depth / ray->z())));
      T_camera_middle.linear() =
          expSo3(Eigen::Vector3d(0, 0, roll)) * expSo3(Eigen::Vector3d(0, tilt_y, 0)) * expSo3(Eigen::Vector3d(tilt_x, 0, 0));
      const Eigen::Isometry3d T_camera_target = T_camera_middle * T_middle_target;
      const std::vector<FaceSight> sights = sightOf(camera, board, T_camera_target);
      if (std::all_of(sights.begin(), sights.end(),
                      [&](const FaceSight& sight) { return sight.complete && inPicture(camera, sight.corners, kMargin); })) {
        poses.push_back(T_camera_target);
        break;
      }
    }
    if (static_cast<int>(poses.size()) == k) {
      throw InsufficientData(
          fmt::format("intrinsics picture {} of {}: no pose of the board fits into the picture in {} draws", k + 1, count, kDrawsOfPose));
    }
  }
  return poses;
}

}  // namespace poecal
