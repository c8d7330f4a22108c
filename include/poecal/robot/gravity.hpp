// What gravity does to the arm: torques about the joints, the load that each joint carries, and how both hang on the masses.
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
  /// what joint k hands on to the body before it.
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

/// The torques are linear in four numbers of each body, its mass m and the moments m c (com in base at q = 0):
///   tau = Y(q) (m_1, m_1 c_1, ..., m_n, m_n c_n).
/// @return Y, n x 4n; row k is zero left of body k. What any unknown masses can do to joint k lies in the span of the functions of row k.
/// @throws InvalidArgument if the chain is of an arm with another number of joints.
Eigen::MatrixXd gravityRegressor(const Arm& arm, const ArmChain& chain, const Eigen::Vector3d& gravity);

/// Likewise the moment that joint k (from 0) carries about its anchor, in base: 3 x 4n, zero left of body k.
Eigen::MatrixXd carriedMomentRegressor(const Arm& arm, const ArmChain& chain, const Eigen::Vector3d& gravity, std::size_t k);

/// Likewise the moment of all bodies about the origin of base: 3 x 4n.
Eigen::MatrixXd baseMomentRegressor(const Arm& arm, const ArmChain& chain, const Eigen::Vector3d& gravity);

}  // namespace poecal
