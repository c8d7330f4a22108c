// An arm by the parameters of Denavit and Hartenberg, and of Hayati where axes are parallel.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "poecal/robot/arm.hpp"

namespace poecal {

/// The rule by which the next axis is given.
enum class DhRule {
  kDh,     ///< by the common normal; beta is 0
  kHayati  ///< of nearly parallel axes, whose common normal is anywhere: d is 0, beta tilts
};

/// One joint: A(q) = Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta), to which q is added at theta (revolute) or d (prismatic).
struct DhRow {
  DhRule rule = DhRule::kDh;
  double a = 0.0;      ///< [m]
  double alpha = 0.0;  ///< [rad]
  double d = 0.0;      ///< [m]
  double theta = 0.0;  ///< [rad]
  double beta = 0.0;   ///< [rad]
};

/// T_base_flange(q) = base A_1(q_1) ... A_n(q_n) tool. Of the last joint a, alpha and beta are 0: what stands behind it is the tool.
struct DhTable {
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  std::vector<DhRow> rows;
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  /// Neither base nor tool is needed beside the rows, to 1e-9 m and rad.
  bool plain() const;
};

/// The nominal arm, and the calibrated one by the same rules and signs, so that their rows compare one by one.
///
/// Axes within 0.1 rad of parallel in the nominal arm follow Hayati's rule. `base` is the least motion from the z axis of base to the first
/// joint's axis. A sliding joint's axis is drawn through the frame before it.
/// @throws InvalidArgument where the second is no calibration of the first: differenceOfArms().
/// @see Hayati and Mirmirani (1985), Improving the absolute positioning accuracy of robot manipulators.
struct DhTables {
  DhTable nominal, calibrated;
};
DhTables dhTables(const Arm& nominal, const Arm& calibrated);

/// base A_1(q_1) ... A_n(q_n) tool. @throws InvalidArgument: q of another length.
Eigen::Isometry3d dhForward(const DhTable& table, const Arm& arm, const Eigen::VectorXd& q);

/// Text of dh.yaml (format poecal-dh/1): both tables.
std::string dhYaml(const DhTables& tables, const Arm& arm);

}  // namespace poecal
