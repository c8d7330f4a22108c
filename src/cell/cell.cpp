#include "poecal/cell/cell.hpp"

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// T_near_far: the arm as seen from the camera's side. Its own inverse, so it also turns T_near_far back into T_base_flange.
Eigen::Isometry3d nearFar(Setup setup, const Eigen::Isometry3d& T_base_flange) {
  return setup == Setup::kEyeToHand ? T_base_flange : T_base_flange.inverse();
}

}  // namespace

const char* Registration::nearFrame() const { return setup == Setup::kEyeToHand ? "base" : "flange"; }

const char* Registration::farFrame() const { return setup == Setup::kEyeToHand ? "flange" : "base"; }

Eigen::Isometry3d Registration::cameraTarget(const Eigen::Isometry3d& T_base_flange) const {
  return T_camera_near * nearFar(setup, T_base_flange) * T_far_target;
}

Eigen::Isometry3d Registration::baseFlange(const Eigen::Isometry3d& T_camera_target) const {
  const Eigen::Isometry3d T_near_far = T_camera_near.inverse() * T_camera_target * T_far_target.inverse();
  return nearFar(setup, T_near_far);
}

Eigen::Isometry3d Registration::cameraBase(const Eigen::Isometry3d& T_base_flange) const {
  return setup == Setup::kEyeToHand ? T_camera_near : T_camera_near * T_base_flange.inverse();
}

Eigen::Isometry3d Cell::baseFlange(const Sample& sample) const {
  if (arm && sample.q.size() > 0) return forwardKinematics(*arm, sample.q);
  if (sample.T_base_flange) return *sample.T_base_flange;
  throw InvalidArgument("sample '" + sample.image + "' has neither joint readings for the cell's arm nor a flange pose");
}

std::vector<Corner> predictCorners(const Cell& cell, const Target& target, const Eigen::Isometry3d& T_base_flange) {
  if (!cell.camera) throw InvalidArgument("corners were asked of a cell without a camera");
  const Eigen::Isometry3d T_camera_target = cell.registration.cameraTarget(T_base_flange);
  std::vector<Corner> corners;
  for (const TargetPoint& point : target.points) {
    const std::optional<Eigen::Vector2d> px = project(*cell.camera, T_camera_target * point.p_target);
    if (px) corners.push_back({.id = point.id, .px = *px});
  }
  return corners;
}

}  // namespace poecal
