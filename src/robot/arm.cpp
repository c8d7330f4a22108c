#include "poecal/robot/arm.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "robot/arm_size.hpp"

namespace poecal {
namespace {

Eigen::Vector3d unitAxis(const std::string& joint_name, const Eigen::Vector3d& axis) {
  const double squared = axis.squaredNorm();
  if (!(squared > 0.0) || !std::isfinite(squared)) throw InvalidArgument(fmt::format("joint '{}': its axis has no direction", joint_name));
  // Dividing an axis by a norm that is 1 but for rounding would change its last digits each time an arm is written and read.
  if (std::abs(squared - 1.0) <= 4.0 * std::numeric_limits<double>::epsilon()) return axis;
  return axis / std::sqrt(squared);
}

void checkSize(const char* what, Eigen::Index size, Eigen::Index expected) {
  if (size != expected) throw InvalidArgument(fmt::format("{} {}, expected {}", size, what, expected));
}

}  // namespace

Eigen::Vector3d Joint::axis() const { return type == JointType::kRevolute ? xi.head<3>() : xi.tail<3>(); }

Joint Joint::revolute(std::string name, const Eigen::Vector3d& axis, const Eigen::Vector3d& point) {
  const Eigen::Vector3d w = unitAxis(name, axis);
  Joint joint;
  joint.name = std::move(name);
  joint.type = JointType::kRevolute;
  joint.xi << w, -w.cross(point);
  joint.anchor = point;
  return joint;
}

Joint Joint::prismatic(std::string name, const Eigen::Vector3d& axis, const Eigen::Vector3d& point) {
  const Eigen::Vector3d v = unitAxis(name, axis);
  Joint joint;
  joint.name = std::move(name);
  joint.type = JointType::kPrismatic;
  joint.xi << Eigen::Vector3d::Zero(), v;
  joint.anchor = point;
  return joint;
}

ArmChain forwardChain(const Arm& arm, const Eigen::VectorXd& q) {
  checkSize("joint positions", q.size(), arm.jointCount());
  ArmChain chain;
  chain.P.reserve(arm.joints.size() + 1);
  chain.P.push_back(Eigen::Isometry3d::Identity());
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    chain.P.push_back(chain.P.back() * expSe3(arm.joints[k].xi * q(static_cast<Eigen::Index>(k))));
  }
  chain.T_base_flange = chain.P.back() * expSe3(arm.gamma);
  return chain;
}

Eigen::Isometry3d forwardKinematics(const Arm& arm, const Eigen::VectorXd& q) { return forwardChain(arm, q).T_base_flange; }

Matrix6Xd spaceJacobian(const Arm& arm, const ArmChain& chain) {
  checkSize("poses in the chain", static_cast<Eigen::Index>(chain.P.size()), arm.jointCount() + 1);
  Matrix6Xd J(6, arm.jointCount());
  for (std::size_t k = 0; k < arm.joints.size(); ++k) J.col(static_cast<Eigen::Index>(k)) = adjoint(chain.P[k]) * arm.joints[k].xi;
  return J;
}

Matrix6Xd twistBasis(const Joint& joint) {
  const Eigen::Vector3d axis = joint.axis();
  // The first axis of the frame that is far enough from it. The least aligned one would do too, but an axis along y is as far from x as
  // from z: the smallest tilt would turn the two directions by a right angle, and with them whatever is told in them.
  constexpr double kFar = 0.63;  // above 1/sqrt(3), so that there is always one, and the cosine of no angle that machines are built to
  Eigen::Index far = 0;
  while (std::abs(axis(far)) > kFar) ++far;
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(far);
  const Eigen::Vector3d a = (unit - axis.dot(unit) * axis).normalized();
  const Eigen::Vector3d b = axis.cross(a);
  Matrix6Xd B(6, twistParameterCount(joint));
  B.col(0) << a, -a.cross(joint.anchor);
  B.col(1) << b, -b.cross(joint.anchor);
  if (joint.type == JointType::kRevolute) {
    B.col(2) << Eigen::Vector3d::Zero(), a;
    B.col(3) << Eigen::Vector3d::Zero(), b;
  }
  return B;
}

int twistParameterCount(const Joint& joint) { return joint.type == JointType::kRevolute ? 4 : 2; }

int twistParameterCount(const Arm& arm) {
  int count = 0;
  for (const Joint& joint : arm.joints) count += twistParameterCount(joint);
  return count;
}

std::vector<std::string> twistParameterNames(const Arm& arm) {
  constexpr const char* kDirections[] = {"tilt a", "tilt b", "shift a", "shift b"};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    for (int column = 0; column < twistParameterCount(arm.joints[k]); ++column) {
      names.push_back(fmt::format("joint {} {}", k + 1, kDirections[column]));
    }
  }
  return names;
}

Arm displaceTwists(const Arm& nominal, const Eigen::VectorXd& beta) {
  checkSize("twist parameters", beta.size(), twistParameterCount(nominal));
  Arm arm = nominal;
  Eigen::Index first = 0;
  for (Joint& joint : arm.joints) {
    const int count = twistParameterCount(joint);
    const Eigen::Isometry3d motion = expSe3(twistBasis(joint) * beta.segment(first, count));
    first += count;
    // Built anew from axis and point, which is Ad(motion) xi, so that the joint constraints do not wear off over many updates.
    const Eigen::Vector3d axis = motion.linear() * joint.axis();
    const Eigen::Vector3d anchor = motion * joint.anchor;
    Joint moved =
        joint.type == JointType::kRevolute ? Joint::revolute(joint.name, axis, anchor) : Joint::prismatic(joint.name, axis, anchor);
    moved.limits = joint.limits;
    joint = std::move(moved);
  }
  return arm;
}

AxisOffset axisOffset(const Joint& from, const Joint& to) {
  AxisOffset offset;
  offset.tilt = std::atan2(from.axis().cross(to.axis()).norm(), from.axis().dot(to.axis()));
  if (to.type == JointType::kRevolute) offset.shift = to.axis().cross(from.anchor - to.anchor).norm();
  return offset;
}

std::string differenceOfArms(const Arm& nominal, const Arm& calibrated) {
  constexpr double kTilt = 0.5, kShiftOfReach = 0.1;
  if (calibrated.jointCount() != nominal.jointCount()) {
    return fmt::format("{} joints, expected {}", calibrated.jointCount(), nominal.jointCount());
  }
  const double farthest = kShiftOfReach * reachOf(nominal);
  for (std::size_t k = 0; k < nominal.joints.size(); ++k) {
    const Joint &from = nominal.joints[k], &to = calibrated.joints[k];
    if (from.type != to.type) {
      const auto typeName = [](const Joint& joint) { return joint.type == JointType::kRevolute ? "revolute" : "prismatic"; };
      return fmt::format("joint {} is {}, expected {}", k + 1, typeName(to), typeName(from));
    }
    const AxisOffset offset = axisOffset(from, to);
    if (offset.tilt <= kTilt && offset.shift <= farthest) continue;
    return fmt::format("axis {} is {:.0f} degrees and {:.0f} mm from where it should be", k + 1, offset.tilt * 180.0 / std::numbers::pi,
                       1e3 * offset.shift);
  }
  return "";
}

Eigen::VectorXd twistDisplacement(const Arm& nominal, const Arm& arm) {
  checkSize("joints", arm.jointCount(), nominal.jointCount());
  constexpr int kSteps = 20;  // Gauss-Newton on a residual that can be zero: digits double at each
  constexpr double kRounding = 1e-14;
  Eigen::VectorXd all(twistParameterCount(nominal));
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < nominal.joints.size(); ++k) {
    if (nominal.joints[k].type != arm.joints[k].type) throw InvalidArgument(fmt::format("joint {} is of another type", k + 1));
    const Matrix6Xd B = twistBasis(nominal.joints[k]);
    Eigen::VectorXd beta = Eigen::VectorXd::Zero(B.cols());
    for (int step = 0; step < kSteps; ++step) {
      const Vector6d eta = B * beta;
      const Vector6d xi = adjoint(expSe3(eta)) * nominal.joints[k].xi;
      const Matrix6Xd D = -adjointOfTwist(xi) * leftJacobianSe3(eta) * B;
      const Eigen::VectorXd change = D.colPivHouseholderQr().solve(arm.joints[k].xi - xi);
      beta += change;
      if (change.norm() < kRounding) break;
    }
    all.segment(first, beta.size()) = beta;
    first += beta.size();
  }
  return all;
}

Matrix6Xd twistJacobian(const Arm& nominal, const Eigen::VectorXd& beta, const Arm& arm, const ArmChain& chain, const Eigen::VectorXd& q) {
  const int parameters = twistParameterCount(nominal);
  checkSize("twist parameters", beta.size(), parameters);
  checkSize("joint positions", q.size(), arm.jointCount());
  checkSize("joints of the displaced arm", arm.jointCount(), nominal.jointCount());
  checkSize("poses in the chain", static_cast<Eigen::Index>(chain.P.size()), arm.jointCount() + 1);
  Matrix6Xd J(6, parameters);
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const Matrix6Xd B = twistBasis(nominal.joints[k]);
    const Matrix6d Ad_motion = adjoint(expSe3(arm.joints[k].xi * q(static_cast<Eigen::Index>(k))));
    const Matrix6d J_displacement = adjoint(chain.P[k]) * (Matrix6d::Identity() - Ad_motion);
    J.middleCols(first, B.cols()) = J_displacement * leftJacobianSe3(B * beta.segment(first, B.cols())) * B;
    first += B.cols();
  }
  return J;
}

}  // namespace poecal
