#include "poecal/cell/ports.hpp"

#include <fmt/format.h>

#include "cell/linearisation.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

void checkLength(const char* port, Eigen::Index size, Eigen::Index expected) {
  if (size != 0 && size != expected) {
    throw InvalidArgument(fmt::format("a disturbance has {} values for {}, expected {}", size, port, expected));
  }
}

void checkArmPorts(const Cell& cell, const Sample& sample, const Disturbance& disturbance) {
  const bool moves = cell.arm && sample.q.size() > 0;
  const Eigen::Index joints = moves ? cell.arm->jointCount() : 0;
  checkLength("the joints", disturbance.joints.size(), joints);
  checkLength("the links", static_cast<Eigen::Index>(disturbance.links.size()), joints);
}

/// A copy of the sample's points where the disturbed target has them.
Eigen::Vector3d shapedPoint(const std::vector<TargetPoint>& points, const Disturbance& disturbance, std::size_t j) {
  return disturbance.points.empty() ? points[j].p_target : Eigen::Vector3d(points[j].p_target + disturbance.points[j]);
}

void checkPointPorts(const std::vector<TargetPoint>& points, const Disturbance& disturbance) {
  checkLength("the points", static_cast<Eigen::Index>(disturbance.points.size()), static_cast<Eigen::Index>(points.size()));
  checkLength("the pixels", static_cast<Eigen::Index>(disturbance.pixels.size()), static_cast<Eigen::Index>(points.size()));
}

/// J by a left perturbation, as the derivative by a twist at `at`.
Matrix6d atTwist(const Matrix6d& J, const Vector6d& at) { return at.isZero(0.0) ? J : Matrix6d(J * leftJacobianSe3(at)); }

double jointOffset(const Disturbance& disturbance, Eigen::Index k) { return disturbance.joints.size() == 0 ? 0.0 : disturbance.joints(k); }

/// The disturbed chain: where each joint and each link's port stands.
struct DisturbedChain {
  std::vector<Eigen::Isometry3d> before_joint;  ///< all that stands before exp(xi_k q_k), and last before exp(gamma)
  std::vector<Eigen::Isometry3d> before_link;   ///< all that stands before exp(l_k)
  Eigen::Isometry3d T_base_flange = Eigen::Isometry3d::Identity();
};

DisturbedChain disturbedChain(const Arm& arm, const Eigen::VectorXd& q, const Disturbance& disturbance) {
  if (q.size() != arm.jointCount()) throw InvalidArgument(fmt::format("{} joint positions, expected {}", q.size(), arm.jointCount()));
  DisturbedChain chain;
  chain.before_joint.reserve(arm.joints.size());
  chain.before_link.reserve(arm.joints.size());
  Eigen::Isometry3d T = disturbance.base.isZero(0.0) ? Eigen::Isometry3d::Identity() : expSe3(disturbance.base);
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const auto index = static_cast<Eigen::Index>(k);
    chain.before_joint.push_back(T);
    T = T * expSe3(arm.joints[k].xi * (q(index) + jointOffset(disturbance, index)));
    chain.before_link.push_back(T);
    if (!disturbance.links.empty()) T = T * expSe3(disturbance.links[k]);
  }
  chain.before_joint.push_back(T);
  chain.T_base_flange = T * expSe3(arm.gamma);
  return chain;
}

Registration disturbedRegistration(const Registration& registration, const Disturbance& disturbance) {
  Registration disturbed = registration;
  disturbed.T_camera_near = expSe3(disturbance.mount) * registration.T_camera_near;
  disturbed.T_far_target = expSe3(disturbance.grip) * registration.T_far_target;
  return disturbed;
}

}  // namespace

Disturbance Disturbance::zero(const Cell& cell, std::size_t points) {
  Disturbance disturbance;
  if (cell.arm) {
    disturbance.joints = Eigen::VectorXd::Zero(cell.arm->jointCount());
    disturbance.links.assign(cell.arm->joints.size(), Vector6d::Zero());
  }
  if (cell.camera) disturbance.intrinsics = Eigen::VectorXd::Zero(cell.camera->parameterCount());
  disturbance.points.assign(points, Eigen::Vector3d::Zero());
  disturbance.pixels.assign(points, Eigen::Vector2d::Zero());
  return disturbance;
}

Eigen::Isometry3d disturbedFlange(const Cell& cell, const Sample& sample, const Disturbance& disturbance) {
  checkArmPorts(cell, sample, disturbance);
  if (cell.arm && sample.q.size() > 0) return disturbedChain(*cell.arm, sample.q, disturbance).T_base_flange;
  return expSe3(disturbance.base) * cell.baseFlange(sample);
}

Eigen::Isometry3d disturbedTarget(const Cell& cell, const Sample& sample, const Disturbance& disturbance) {
  return disturbedRegistration(cell.registration, disturbance).cameraTarget(disturbedFlange(cell, sample, disturbance));
}

Camera disturbedCamera(const Cell& cell, const Disturbance& disturbance) {
  if (!cell.camera) throw InvalidArgument("corners were asked of a cell without a camera");
  checkLength("the intrinsics", disturbance.intrinsics.size(), cell.camera->parameterCount());
  Camera camera = *cell.camera;
  if (disturbance.intrinsics.size() > 0) camera.setParameters(camera.parameters() + disturbance.intrinsics);
  return camera;
}

std::vector<std::optional<Eigen::Vector2d>> disturbedCorners(const Cell& cell, const Sample& sample, const std::vector<TargetPoint>& points,
                                                             const Disturbance& disturbance) {
  checkPointPorts(points, disturbance);
  const Camera camera = disturbedCamera(cell, disturbance);
  const Eigen::Isometry3d T_camera_target = disturbedTarget(cell, sample, disturbance);
  std::vector<std::optional<Eigen::Vector2d>> corners;
  corners.reserve(points.size());
  for (std::size_t j = 0; j < points.size(); ++j) {
    corners.push_back(project(camera, T_camera_target * shapedPoint(points, disturbance, j)));
    if (corners.back() && !disturbance.pixels.empty()) *corners.back() += disturbance.pixels[j];
  }
  return corners;
}

Vector6d PosePortJacobian::along(const Disturbance& direction) const {
  checkLength("the joints", direction.joints.size(), joints.cols());
  checkLength("the links", static_cast<Eigen::Index>(direction.links.size()), static_cast<Eigen::Index>(links.size()));
  Vector6d motion = Vector6d::Zero();
  // Most directions move one port, and there are many directions.
  const auto add = [&motion](const Matrix6d& port, const Vector6d& along_port) {
    if (!along_port.isZero(0.0)) motion += port * along_port;
  };
  add(base, direction.base);
  add(mount, direction.mount);
  add(grip, direction.grip);
  if (direction.joints.size() > 0) motion += joints * direction.joints;
  for (std::size_t k = 0; k < direction.links.size(); ++k) add(links[k], direction.links[k]);
  return motion;
}

Eigen::VectorXd PortJacobian::along(const Disturbance& direction) const {
  const auto count = static_cast<Eigen::Index>(valid.size());
  checkLength("the points", static_cast<Eigen::Index>(direction.points.size()), count);
  checkLength("the pixels", static_cast<Eigen::Index>(direction.pixels.size()), count);
  checkLength("the intrinsics", direction.intrinsics.size(), J_px_intrinsics.cols());
  Eigen::VectorXd pixels = J_px_pose * pose.along(direction);
  if (direction.intrinsics.size() > 0) pixels += J_px_intrinsics * direction.intrinsics;
  for (std::size_t j = 0; j < valid.size(); ++j) {
    if (!valid[j]) continue;
    const auto row = 2 * static_cast<Eigen::Index>(j);
    if (!direction.points.empty()) pixels.segment<2>(row) += J_px_points[j] * direction.points[j];
    if (!direction.pixels.empty()) pixels.segment<2>(row) += direction.pixels[j];
  }
  return pixels;
}

PosePortJacobian posePortJacobian(const Cell& cell, const Sample& sample, const Disturbance& at) {
  checkArmPorts(cell, sample, at);
  PosePortJacobian jacobian;
  const Registration registration = disturbedRegistration(cell.registration, at);
  DisturbedChain chain;
  if (cell.arm && sample.q.size() > 0) {
    chain = disturbedChain(*cell.arm, sample.q, at);
  } else {
    chain.T_base_flange = disturbedFlange(cell, sample, at);
  }
  jacobian.T_camera_target = registration.cameraTarget(chain.T_base_flange);
  // A left perturbation of T_base_flange in base is one of T_camera_target in camera: by Ad(T_camera_base), and turned round in hand,
  // where the arm enters as its inverse.
  const double sign = registration.setup == Setup::kEyeToHand ? 1.0 : -1.0;
  const Matrix6d J_pose_flange = sign * adjoint(registration.cameraBase(chain.T_base_flange));
  jacobian.joints.resize(6, static_cast<Eigen::Index>(chain.before_link.size()));
  jacobian.links.reserve(chain.before_link.size());
  for (std::size_t k = 0; k < chain.before_link.size(); ++k) {
    const Vector6d xi_base = adjoint(chain.before_joint[k]) * cell.arm->joints[k].xi;
    jacobian.joints.col(static_cast<Eigen::Index>(k)) = J_pose_flange * xi_base;
    const Matrix6d J_pose_link = J_pose_flange * adjoint(chain.before_link[k]);
    jacobian.links.push_back(at.links.empty() ? J_pose_link : atTwist(J_pose_link, at.links[k]));
  }
  jacobian.base = atTwist(J_pose_flange, at.base);
  jacobian.mount = leftJacobianSe3(at.mount);
  // exp(grip) stands in the far frame as the undisturbed T_far_target leaves it.
  const Eigen::Isometry3d T_camera_far = jacobian.T_camera_target * registration.T_far_target.inverse();
  jacobian.grip = atTwist(adjoint(T_camera_far), at.grip);
  return jacobian;
}

PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Sample& sample, const Disturbance& at) {
  checkArmPorts(state.cell, sample, at);
  const Registration registration = disturbedRegistration(state.cell.registration, at);
  ArmChain chain;
  Eigen::VectorXd q;
  if (state.cell.arm && sample.q.size() > 0) {
    q = at.joints.size() > 0 ? Eigen::VectorXd(sample.q + at.joints) : sample.q;
    DisturbedChain disturbed = disturbedChain(*state.cell.arm, sample.q, at);
    chain = {.P = std::move(disturbed.before_joint), .T_base_flange = disturbed.T_base_flange};
  } else {
    chain.T_base_flange = disturbedFlange(state.cell, sample, at);
  }
  PoseDerivative derivative = evaluatePose(state, layout, registration, chain, q);
  if (layout.near >= 0) derivative.M.middleCols<6>(layout.near) = adjoint(expSe3(at.mount));
  return derivative;
}

PortJacobian portJacobian(const Cell& cell, const Sample& sample, const std::vector<TargetPoint>& points, const Disturbance& at) {
  checkPointPorts(points, at);
  Cell disturbed = cell;
  disturbed.camera = disturbedCamera(cell, at);
  PortJacobian jacobian;
  jacobian.pose = posePortJacobian(cell, sample, at);
  Observation observation;
  for (std::size_t j = 0; j < points.size(); ++j) {
    observation.corners.push_back({.id = points[j].id, .p_target = shapedPoint(points, at, j)});
  }
  SampleRows rows;
  evaluateRows(disturbed, observation, jacobian.pose.T_camera_target, true, rows);
  jacobian.J_px_pose = rows.H;
  jacobian.J_px_intrinsics = rows.K;
  jacobian.valid = rows.valid;
  // The pixel moves with p_camera as with a translation of the target in camera.
  const Eigen::Matrix3d R_camera_target = jacobian.pose.T_camera_target.linear();
  for (std::size_t j = 0; j < points.size(); ++j) {
    jacobian.J_px_points.push_back(rows.H.block<2, 3>(2 * static_cast<Eigen::Index>(j), 3) * R_camera_target);
  }
  return jacobian;
}

}  // namespace poecal
