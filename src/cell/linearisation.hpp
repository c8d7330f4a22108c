// One sample's residuals and their derivatives by T_camera_target and by the intrinsics, and how the free parameters move T_camera_target.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "poecal/cell/adjustment.hpp"
#include "poecal/cell/ports.hpp"

namespace poecal {

/// Where each block of free parameters begins in the vector of all.
struct ParameterLayout {
  ParameterLayout(const Cell& cell, const FreeParameters& free);
  int twists = 0;                                        ///< number of twist parameters; they begin at 0
  int gamma = -1, near = -1, far = -1, intrinsics = -1;  ///< begin, or -1 where held
  int pose_parameters = 0;                               ///< all but the intrinsics
  int total = 0;
};

std::vector<std::string> parameterNames(const Cell& cell, const FreeParameters& free);

/// A cell on its way from the nominal one: the arm is displaceTwists(reference, beta).
struct CellState {
  CellState() = default;
  explicit CellState(const Cell& nominal, const FreeParameters& free);
  /// The state after a step of the free parameters.
  CellState moved(const ParameterLayout& layout, const Eigen::VectorXd& step) const;

  Cell cell;
  std::optional<Arm> reference;  ///< nominal twists with the present gamma
  Eigen::VectorXd beta;          ///< empty where the twists are held
};

/// 1 sigma of the independent priors of the free parameters, which the twists have none of; infinity where there is none.
/// @param start  the cell whose registration says what is known of the transforms.
Eigen::VectorXd priorSigma(const ParameterLayout& layout, const AdjustmentOptions& options, const Cell& start);
/// x - x0 of the parameters that priors may be about (twists, transforms, intrinsics): from what is known, or from where the cell started;
/// 0 for the others.
Eigen::VectorXd priorDeviation(const CellState& state, const ParameterLayout& layout, const Cell& start);

/// Residuals r (m), d(model)/d(T_camera_target) = H (m x 6, left perturbation in camera) and d(model)/d(intrinsics) = K (m x k), all in
/// units of the stated sigma. Units that cannot be projected have valid = false and zero rows.
struct SampleRows {
  Eigen::VectorXd r;
  Eigen::Matrix<double, Eigen::Dynamic, 6> H;
  Eigen::MatrixXd K;
  std::vector<bool> valid;  ///< per unit
  int unit_size = 2;
};

/// @param intrinsics  whether K is wanted.
void evaluateRows(const Cell& cell, const Observation& observation, const Eigen::Isometry3d& T_camera_target, bool intrinsics,
                  SampleRows& rows);

/// d(T_camera_target)/d(pose parameters) at an observation, 6 x layout.pose_parameters, and T_camera_target itself.
struct PoseDerivative {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  Matrix6Xd M;
};
PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Observation& observation);
/// @param chain  the cell's arm there; where neither twists nor gamma are free, its T_base_flange is enough.
PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Observation& observation, const ArmChain& chain);
/// @param registration  with what disturbs it, as the chain and q are; the derivative is by that of the state. Columns of the near
/// transform are those of a left perturbation of what is given.
PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Registration& registration, const ArmChain& chain,
                            const Eigen::VectorXd& q);
/// In a cell that is disturbed.
PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Sample& sample, const Disturbance& at);

/// T_camera_target of an observation.
Eigen::Isometry3d modelTarget(const Cell& cell, const Observation& observation);

}  // namespace poecal
