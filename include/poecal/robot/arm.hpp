// The serial arm as twists: forward kinematics and its derivatives in the product-of-exponentials form.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/geometry/se3.hpp"

namespace poecal {

enum class JointType { kRevolute, kPrismatic };

/// Range of a joint reading [rad] or [m].
struct JointLimits {
  double lower = 0.0;
  double upper = 0.0;
};

/// One joint of the arm at q = 0, in base. Joints count from 1 in names and messages, from 0 in vectors.
struct Joint {
  std::string name;
  JointType type = JointType::kRevolute;
  /// Twist in base. Revolute: (w; -w x point), |w| = 1. Prismatic: (0; v), |v| = 1.
  Vector6d xi = Vector6d::Zero();
  /// A point of the axis (revolute) or any point (prismatic) [m]; tolerances and shifts of the axis are stated there.
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
  std::optional<JointLimits> limits;
  std::optional<double> largest_speed;  ///< [rad/s] or [m/s], as a URDF states it: what readings may not be far beyond

  /// Unit direction of the axis in base: w or v.
  Eigen::Vector3d axis() const;
  /// Joints from a direction of any length (normalised; one that is of unit length already keeps its bits) and a point [m], in base
  /// at q = 0. @throws InvalidArgument if the direction is zero or not finite.
  static Joint revolute(std::string name, const Eigen::Vector3d& axis, const Eigen::Vector3d& point);
  static Joint prismatic(std::string name, const Eigen::Vector3d& axis, const Eigen::Vector3d& point = Eigen::Vector3d::Zero());
};

/// The body that a joint moves: mass [kg] and centre of mass in base at q = 0 [m].
struct LinkMass {
  double mass = 0.0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();
};

/// Arm: T_base_flange(q) = exp(xi_1 q_1) ... exp(xi_n q_n) exp(gamma).
struct Arm {
  std::string name;
  std::vector<Joint> joints;
  /// Gamma, the twist of T_base_flange(0).
  Vector6d gamma = Vector6d::Zero();
  /// Empty, or one per joint.
  std::vector<LinkMass> links;

  int jointCount() const { return static_cast<int>(joints.size()); }
};

/// Products of the exponentials for one joint vector.
struct ArmChain {
  /// P[k] = exp(xi_1 q_1) ... exp(xi_k q_k), P[0] = I; n + 1 entries. P[k] is the motion of body k since q = 0.
  std::vector<Eigen::Isometry3d> P;
  Eigen::Isometry3d T_base_flange = Eigen::Isometry3d::Identity();
};

/// @param q  n joint positions [rad] or [m]. @throws InvalidArgument if q.size() is not the number of joints.
ArmChain forwardChain(const Arm& arm, const Eigen::VectorXd& q);
/// T_base_flange(q), so that p_base = T_base_flange p_flange.
Eigen::Isometry3d forwardKinematics(const Arm& arm, const Eigen::VectorXd& q);

/// Space Jacobian, 6 x n: column k = Ad(P[k-1]) xi_k = left derivative (in base) of T_base_flange by q_k.
/// @throws InvalidArgument if the chain is of an arm with another number of joints.
/// @see Lynch and Park, Modern Robotics (2017), 5.1.1.
Matrix6Xd spaceJacobian(const Arm& arm, const ArmChain& chain);

/// Directions eta, 6 x 4 (revolute) or 6 x 2 (prismatic), in which the adjoint xi <- Ad(exp(eta)) xi moves a joint at all.
///
/// Revolute: two tilts about the anchor and two shifts across the axis; what is left out, turning about and sliding along the
/// axis, changes nothing. Prismatic: two tilts. Columns: tilt a, tilt b, shift a, shift b, with (a, b, axis) right-handed;
/// [rad], [rad], [m], [m] of the axis at the anchor. a is the part across the axis of the first of x, y, z that is 51 degrees or more from
/// it, so that an axis which tilts a little takes a and b along.
Matrix6Xd twistBasis(const Joint& joint);
/// Number of columns of twistBasis: 4 or 2.
int twistParameterCount(const Joint& joint);
/// Sum over the joints: 4 r + 2 p.
int twistParameterCount(const Arm& arm);
/// "joint 3 tilt a", ... in the order of the columns.
std::vector<std::string> twistParameterNames(const Arm& arm);

/// The arm whose twists are xi_i = Ad(exp(B_i beta_i)) xi_i of `nominal`, B_i = twistBasis (Gao 2013, eqs. 8 and 12): joint
/// constraints hold by construction. Anchors move along; gamma, limits and links stay.
/// @param beta  twistParameterCount(nominal) values. @throws InvalidArgument if there are more or fewer.
Arm displaceTwists(const Arm& nominal, const Eigen::VectorXd& beta);

/// The beta with displaceTwists(nominal, beta) nearest to `arm`: its inverse, to 1e-12, for axes that differ by less than a right angle.
/// @throws InvalidArgument if the arms have other joints.
Eigen::VectorXd twistDisplacement(const Arm& nominal, const Arm& arm);

/// The difference between two positions of one axis, whichever points on it are given.
struct AxisOffset {
  double tilt = 0.0;   ///< Angle between the directions [rad], 0..pi.
  double shift = 0.0;  ///< Revolute: distance of the anchor of `from` to the axis of `to` [m]. Prismatic: 0, it has no position.
};

AxisOffset axisOffset(const Joint& from, const Joint& to);

/// Why `calibrated` can be no calibration of `nominal`: other joints, or an axis 30 degrees or a tenth of the arm's reach away from where
/// it should be, which no arm errs by. Empty where it can be one. The names of the joints do not count.
std::string differenceOfArms(const Arm& nominal, const Arm& calibrated);

/// Left derivative of T_base_flange (in base) by beta at displaceTwists(nominal, beta), 6 x twistParameterCount:
///   J_i = Ad(P[i-1]) (I - Ad(exp(xi_i q_i))) K(B_i beta_i) B_i      (Gao 2013, eq. 21)
/// @param arm, chain  displaceTwists(nominal, beta) and its chain at q.
/// @throws InvalidArgument if beta, q or the chain is of another size than the arm asks for.
Matrix6Xd twistJacobian(const Arm& nominal, const Eigen::VectorXd& beta, const Arm& arm, const ArmChain& chain, const Eigen::VectorXd& q);

}  // namespace poecal
