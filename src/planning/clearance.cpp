#include "planning/clearance.hpp"

#include <algorithm>
#include <cmath>

namespace poecal {
namespace {

constexpr double kThickness = 0.04;   ///< radius of a link, of the arm's length
constexpr std::size_t kOwnWrist = 4;  ///< links before the flange that it is beside anyway: the wrist and what carries it

}  // namespace

double segmentDistance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0, const Eigen::Vector3d& b1) {
  const Eigen::Vector3d a = a1 - a0, b = b1 - b0, r = a0 - b0;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b), ar = a.dot(r), br = b.dot(r);
  constexpr double kPoint = 1e-24;  // [m^2]
  double s = 0.0, t = 0.0;
  if (aa > kPoint) {
    const double denominator = aa * bb - ab * ab;
    if (denominator > kPoint * aa) s = std::clamp((ab * br - ar * bb) / denominator, 0.0, 1.0);
    if (bb <= kPoint) s = std::clamp(-ar / aa, 0.0, 1.0);
  }
  if (bb > kPoint) {
    t = (ab * s + br) / bb;
    if (t < 0.0 || t > 1.0) {
      t = std::clamp(t, 0.0, 1.0);
      if (aa > kPoint) s = std::clamp((t * ab - ar) / aa, 0.0, 1.0);
    }
  }
  return (r + s * a - t * b).norm();
}

Clearance::Clearance(const Cell& cell, const Eigen::Vector3d& gravity, const PlanOptions& options)
    : cell_(cell),
      up_(gravity.isZero() ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(-gravity.normalized())),
      radius_(options.link_radius),
      camera_radius_(options.camera_radius),
      floor_(options.floor) {
  if (radius_ > 0.0) return;
  const std::vector<Eigen::Vector3d> at_zero = points(forwardChain(*cell.arm, Eigen::VectorXd::Zero(cell.arm->jointCount())));
  double length = 0.0;
  for (std::size_t k = 1; k < at_zero.size(); ++k) length += (at_zero[k] - at_zero[k - 1]).norm();
  radius_ = kThickness * length;
}

std::vector<Eigen::Vector3d> Clearance::points(const ArmChain& chain) const {
  std::vector<Eigen::Vector3d> points{Eigen::Vector3d::Zero()};
  for (std::size_t k = 0; k < cell_.arm->joints.size(); ++k) {
    const Joint& joint = cell_.arm->joints[k];
    if (joint.type == JointType::kRevolute) points.push_back(chain.P[k] * joint.anchor);
  }
  points.push_back(chain.T_base_flange.translation());
  return points;
}

bool Clearance::isFree(const Eigen::VectorXd& q) const {
  const ArmChain chain = forwardChain(*cell_.arm, q);
  const std::vector<Eigen::Vector3d> p = points(chain);
  const bool in_hand = cell_.registration.setup == Setup::kEyeInHand;
  const Eigen::Isometry3d T_base_camera = cell_.registration.cameraBase(chain.T_base_flange).inverse();
  const Eigen::Vector3d camera = T_base_camera.translation();
  const Eigen::Vector3d target = T_base_camera * cell_.registration.cameraTarget(chain.T_base_flange).translation();
  // What stands still must not be touched; what is carried is beside the last link.
  const Eigen::Vector3d& still = in_hand ? target : camera;
  const double before_target = std::max(0.0, (target - camera).norm() - 3.0 * radius_);
  const Eigen::Vector3d line_end = camera + before_target * (target - camera).normalized();
  const Eigen::Vector3d line_begin =
      in_hand ? Eigen::Vector3d(camera + std::min(3.0 * radius_, before_target) * (target - camera).normalized()) : camera;
  const Eigen::Vector3d& flange = p.back();
  for (std::size_t k = 1; k < p.size(); ++k) {
    if (segmentDistance(p[k - 1], p[k], still, still) < radius_ + camera_radius_) return false;
    const bool last = k + 1 == p.size();
    if (!last && segmentDistance(p[k - 1], p[k], line_begin, line_end) < radius_) return false;
    if (k + kOwnWrist < p.size() && segmentDistance(p[k - 1], p[k], flange, flange) < 2.0 * radius_) return false;
    if (floor_ && k > 1 && up_.dot(p[k]) < *floor_ + radius_) return false;
  }
  return !floor_ || up_.dot(in_hand ? camera : target) > *floor_;
}

}  // namespace poecal
