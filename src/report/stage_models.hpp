// The models of a calibration, from the arm as drawn to the one with the findings, and what each leaves of every sample.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "poecal/calibration/calibrate.hpp"
#include "poecal/cell/measurements.hpp"
#include "poecal/effects/effect.hpp"

namespace poecal {

/// One model stage, fitted to all poses.
struct StageModel {
  std::string name;
  Cell cell;
  std::vector<AppliedEffect> effects;
};

/// All stages, and which two of them a picture compares.
struct StageModels {
  std::vector<StageModel> stages;  ///< nominal, registered, identified and, where there are findings, the diagnosed one
  std::size_t before = 0;          ///< the geometric model
  std::size_t after = 0;           ///< the model that was kept
};
/// @throws InvalidArgument where the arm was not identified.
StageModels stageModels(const Calibration& calibration);

/// The identification that the diagnosis started from, or the one there is.
const Identification& reportedIdentification(const Calibration& calibration);

/// A stage at each sample of the measurements.
class StageAt {
 public:
  /// @param measurements  outlive this; samples with what the order of the rows stands in for.
  StageAt(const StageModel& stage, const Measurements& measurements);

  /// What was measured less what the model expects: 2 numbers a corner [px], or 6 of a pose (rad; m), or 3 of a position [m]. NaN where a
  /// corner cannot be projected.
  Eigen::VectorXd residual(const Observation& observation) const;
  Eigen::Isometry3d cameraTarget(const Observation& observation) const;
  Eigen::Isometry3d baseFlange(const Observation& observation) const;
  const Disturbance& disturbance(std::size_t sample) const { return disturbances_[sample]; }

 private:
  const StageModel& stage_;
  const Measurements& measurements_;
  std::vector<Disturbance> disturbances_;  ///< per sample
};

/// How the measured numbers of an observation move with its joints, one column per joint, and with a disturbance of any kind.
class MeasuredMotion {
 public:
  MeasuredMotion(const Cell& cell, const Sample& sample, const Observation& observation, const Target& target);
  const Eigen::MatrixXd& byJoints() const { return joints_; }
  /// First order. @param disturbance  its points and pixels are those of the target.
  Eigen::VectorXd along(const Disturbance& disturbance) const;
  /// The error d_k of joint k alone that comes nearest to residuals r, d_k = J_k' W r / (J_k' W J_k), for every joint [rad, m]; NaN where
  /// the joint moves nothing that was measured.
  Eigen::VectorXd jointErrors(const Eigen::VectorXd& r) const;

 private:
  Eigen::VectorXd alongPose(const Vector6d& motion) const;

  const Observation& observation_;
  const Target& target_;
  PortJacobian corners_;
  PosePortJacobian pose_;
  Eigen::MatrixXd joints_;
  Eigen::VectorXd weight_;  ///< of each number
};

}  // namespace poecal
