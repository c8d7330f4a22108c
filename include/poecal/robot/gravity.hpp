// What gravity does to the arm: torques about the joints, the load that each joint carries, and how they depend on the masses.
#pragma once

#include <Eigen/Core>

#include "poecal/robot/arm.hpp"

namespace poecal {

/// Gravity's load at one configuration.
struct GravityLoad {
  /// n: generalised force of gravity on each joint, tau_k = -dU/dq_k, U = -sum_j m_j g . c_j [N m] or [N]. It pulls the joint in the
  /// direction of tau; a drive at rest holds -tau.
  Eigen::VectorXd torque;
  /// n columns (moment about the place of joint k's anchor; force) of gravity on all bodies from k on, in base [N m; N]:
  /// what joint k passes on to the body before it.
  Matrix6Xd carried;
  /// Moment about the origin of base and force of gravity on the whole arm, in base [N m; N].
  Vector6d base = Vector6d::Zero();
};

/// Load of the links' masses and of a point mass at the flange's origin:
///   tau_k = xi_k' . sum_{j >= k} (c_j x m_j g; m_j g),   xi_k' the present twist of joint k in base.
/// @param gravity  acceleration in base [m/s^2].
/// @param payload  mass at the flange's origin [kg].
/// @throws InvalidArgument where the arm's links are not one per joint, or the chain is of another arm.
GravityLoad gravityLoad(const Arm& arm, const ArmChain& chain, const Eigen::Vector3d& gravity, double payload = 0.0);

/// Gravity's wrench on each body is linear in four numbers of it, its mass m and the moments m c (com in base at q = 0):
///   (moment about the origin of base; force) = sum_b W_b(q) (m_b, m_b c_b).
/// @return W, 6 x 4n, four columns a body. @throws InvalidArgument if the chain is of an arm with another number of joints.
Matrix6Xd gravityRegressor(const Arm& arm, const ArmChain& chain, const Eigen::Vector3d& gravity);

}  // namespace poecal
