// What is believed of an arm's geometry before it is measured: one prior for identification, held-out folds and diagnosis.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "poecal/robot/arm.hpp"

namespace poecal {

/// What the prior makes of one joint of a displaced arm: how its axis stands in the link before it, and where its zero is.
struct JointDeviation {
  double tilt = 0.0;   ///< of the axis [rad]
  double shift = 0.0;  ///< of the axis [m]
  /// Of the joint's reading [rad], or [m] for a sliding joint; 0 for the last joint, whose zero the tool takes up, and for the first one
  /// where the base takes it up.
  double zero = 0.0;
};

/// Tolerances of the twist parameters beta of displaceTwists() about the nominal arm: beta ~ N(0, covariance).
///
///   beta = sum_j own_j + sum_k moves_k link_k + sum_k moves_k xi_k zero_k
///
/// Each axis is off by itself (own_j), each link is wrongly shaped, which moves all axes after it together (link_k), both with half of the
/// variance of the tolerances; and each joint's zero may be anywhere (zero_k, 0.02 rad), since only its maker's mark tells.
///
/// A motion of the base frame moves all axes together, and no measurement tells of it where the transform beside the base is free. The
/// frame is then the one in which beta' precision beta is smallest, and the first joint has no zero of its own: a turn of the base does the
/// same. This rule does not depend on the data or on what a diagnosis finds.
struct TwistPrior {
  /// No belief at all.
  TwistPrior() = default;
  /// @param position, rotation  1 sigma of an axis' place [m] and tilt [rad], both positive. @param base_known  something is known of the
  /// transform beside the base, so that the first joint's zero shows.
  TwistPrior(const Arm& arm, double position, double rotation, bool base_known = true);

  bool empty() const { return precision.size() == 0; }
  /// The most likely parts of a displacement, one per joint.
  std::vector<JointDeviation> deviations(const Eigen::VectorXd& beta) const;

  Eigen::MatrixXd precision;     ///< inverse of the covariance
  double log_determinant = 0.0;  ///< of the precision

 private:
  Arm arm_;
  Eigen::VectorXd own_variance_;             ///< of each parameter
  std::vector<Eigen::MatrixXd> link_moves_;  ///< of each joint but the last: parameters x 6, by the link behind it
  Eigen::Matrix<double, 6, 1> link_variance_ = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::MatrixXd zero_moves_;     ///< parameters x (joints - 1)
  Eigen::VectorXd zero_variance_;  ///< of each joint but the last
};

/// MacKay's fixed point for the factor by which an arm exceeds its tolerances:
///   factor^2 = beta' P beta / (n - trace(P Sigma) / before^2)
/// with P the precision, Sigma the posterior covariance of beta at the factor `before`, n their number; not below 1, not above 1000.
double updatedTolerance(const TwistPrior& prior, const Eigen::VectorXd& beta, const Eigen::MatrixXd& covariance, double before);

}  // namespace poecal
