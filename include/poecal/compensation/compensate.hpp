// The joints to command so that the real arm's flange goes where it should: the calibrated model turned round, effects included.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/capture/capture.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/effects/effect.hpp"
#include "poecal/robot/arm.hpp"

namespace poecal {

/// The arm as it really moves: calibrated axes, and what it does beyond geometry.
///
///   T_base_flange = f(q) = exp(b) exp(xi_1 (q_1 + d_1)) exp(l_1) ... exp(xi_n (q_n + d_n)) exp(l_n) exp(Gamma)
///
/// d, l and b are what the effects at joints, links and base do at the commanded q and in the sample's other columns (see ports.hpp).
struct RealArm {
  Arm arm;
  std::vector<AppliedEffect> effects = {};      ///< those that movesFlange() refuses do not enter
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  ///< in base [m/s^2]
};

/// Whether an effect moves the flange by a known amount: it is at a joint, a link or the base, and not random. What stands at camera,
/// target, timing or samples disturbs the measurement alone.
bool movesFlange(const Effect& effect);

/// T_base_flange that each command really reaches. @param commands  with q, and the columns that the effects follow; without `dir` columns
/// standInByRowOrder() tells the sides.
/// @throws InsufficientData: an effect follows a column that is not there, InvalidArgument: q of another length.
std::vector<Eigen::Isometry3d> reachedPoses(const RealArm& arm, const SampleTable& commands);

/// What to command for one wanted pose.
struct JointCommand {
  Eigen::VectorXd start;                                            ///< where the search began [rad] or [m]
  Eigen::VectorXd q;                                                ///< to command [rad] or [m]
  Eigen::Isometry3d T_base_flange = Eigen::Isometry3d::Identity();  ///< that q really reaches
  double position_error = 0.0;                                      ///< distance of its origin from the wanted one [m]
  double rotation_error = 0.0;                                      ///< angle between it and the wanted one [rad], 0..pi
  std::string why_not;                                              ///< why the wanted pose is not reached; one clause. Empty where it is
};

/// Solves f(q) = T_wanted for q within the joints' limits, one row after the other. Base and flange are those of the model: what no camera
/// can tell of them stays as the calibration put it.
///
/// Each step is that of Levenberg and Marquardt with the damping |e|^2 / 2, e = (0.1 m log(R_wanted R^T); p_wanted - p): the smallest
/// motion of the joints that serves, so that an arm of more than six joints stays near the start. An arm of fewer than six comes as near as
/// |e| allows, and its errors say how near. A joint at its limit stays there while it would have to go further.
///
/// @param wanted  T_base_flange is wanted of each sample. The search begins at q; where there is none, at the joints with which `start_arm`
///   reaches the pose, found from the row before (the first: from the middle of the joints' ranges). Other columns as reachedPoses().
/// @param start_arm  nullptr: the real arm without its effects.
/// @param progress  told of each row; may be empty.
/// @throws InsufficientData: an effect follows a column that is not there. InvalidArgument: a sample without a wanted pose.
/// @see Sugihara (2011), Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method.
std::vector<JointCommand> compensate(const RealArm& arm, const SampleTable& wanted, const Arm* start_arm = nullptr,
                                     const ProgressFunction& progress = {});

/// Text of the table of commands: `line` of the row asked for, q1..qn, the pose really reached and its distance from the wanted one. Rows
/// that are not reached are left out.
std::string commandsCsv(const SampleTable& wanted, const std::vector<JointCommand>& commands);

}  // namespace poecal
