#include "poecal/robot/gravity.hpp"

#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

void checkChain(const Arm& arm, const ArmChain& chain) {
  if (chain.P.size() != arm.joints.size() + 1) {
    throw InvalidArgument(fmt::format("{} poses in the chain, expected {}", chain.P.size(), arm.joints.size() + 1));
  }
}

/// Wrench (moment about the origin of base; force) of gravity on a body by (m, m c): 6 x 4. P is the body's motion since q = 0.
Eigen::Matrix<double, 6, 4> bodyWrench(const Eigen::Isometry3d& P, const Eigen::Vector3d& gravity) {
  Eigen::Matrix<double, 6, 4> W = Eigen::Matrix<double, 6, 4>::Zero();
  // (R c + t) x m g = t x g m - g x R (m c)
  W.block<3, 1>(0, 0) = P.translation().cross(gravity);
  W.block<3, 3>(0, 1) = -hat(gravity) * P.linear();
  W.block<3, 1>(3, 0) = gravity;
  return W;
}

Eigen::Vector4d massNumbers(const LinkMass& link) {
  Eigen::Vector4d numbers;
  numbers << link.mass, link.mass * link.com;
  return numbers;
}

}  // namespace

GravityLoad gravityLoad(const Arm& arm, const ArmChain& chain, const Eigen::Vector3d& gravity, double payload) {
  checkChain(arm, chain);
  if (arm.links.size() != arm.joints.size()) {
    throw InvalidArgument(fmt::format("gravity's load was asked of an arm with {} links, expected one for each of {} joints",
                                      arm.links.size(), arm.joints.size()));
  }
  const Matrix6Xd J = spaceJacobian(arm, chain);
  GravityLoad load;
  load.torque.resize(arm.jointCount());
  load.carried.resize(6, arm.jointCount());
  load.base << chain.T_base_flange.translation().cross(payload * gravity), payload * gravity;
  for (std::size_t k = arm.joints.size(); k-- > 0;) {
    const auto column = static_cast<Eigen::Index>(k);
    load.base += bodyWrench(chain.P[k + 1], gravity) * massNumbers(arm.links[k]);
    load.torque(column) = J.col(column).dot(load.base);
    const Eigen::Vector3d anchor_base = chain.P[k] * arm.joints[k].anchor;
    load.carried.col(column) << load.base.head<3>() - anchor_base.cross(load.base.tail<3>()), load.base.tail<3>();
  }
  return load;
}

Matrix6Xd gravityRegressor(const Arm& arm, const ArmChain& chain, const Eigen::Vector3d& gravity) {
  checkChain(arm, chain);
  Matrix6Xd W(6, 4 * arm.jointCount());
  for (Eigen::Index body = 0; body < arm.jointCount(); ++body) {
    W.middleCols<4>(4 * body) = bodyWrench(chain.P[static_cast<std::size_t>(body) + 1], gravity);
  }
  return W;
}

}  // namespace poecal
