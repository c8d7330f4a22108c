// One fit of one method to one set of observations; folds and reports are built on it.
#pragma once

#include <vector>

#include "poecal/identification/identify.hpp"

namespace poecal {

/// What a fit gives, whatever the method.
struct MethodFit {
  Cell cell;   ///< of the observations: arm calibrated, registration, camera
  Cell start;  ///< of the adjustment: what its priors are about
  FreeParameters free;
  Adjustment adjustment;  ///< weighted, bundle
  std::vector<double> gao_residuals;
  Eigen::MatrixXd covariance;  ///< of `parameter_names`
  std::vector<std::string> parameter_names;
  std::vector<Vector6d> twist_deviation;
  std::optional<Vector6d> gamma_deviation;
  bool converged = false;
};

/// What `weighted` and `gao` fit: measured flange poses, one per observation that has one. Empty for `bundle`.
struct FlangePoses {
  std::vector<Observation> observations;  ///< pose observations in a cell whose transforms are identity
};

/// Measured flange poses of observations in a registered cell. @param registration  of corners: their free poses; nullptr for pose
/// observations.
FlangePoses flangePoses(const Cell& registered, const std::vector<Observation>& observations, const std::vector<RegisteredSample>* samples);

/// How an arm is believed to be made, and how far this one exceeds that.
struct ArmBelief {
  TwistPrior twists;       ///< empty: no belief
  double tolerance = 0.0;  ///< factor; 0: to be estimated
};
/// @param nominal  with what is known of its registration: it decides whether the first joint's zero shows.
ArmBelief armBelief(const Cell& nominal, const IdentifyOptions& options);

/// @param registered  nominal arm with a registration. @param subset  indices into observations (and flange poses).
/// @param camera_free  bundle only.
MethodFit fitMethod(const Cell& registered, const std::vector<Observation>& observations, const FlangePoses& flange,
                    const std::vector<std::size_t>& subset, const IdentifyOptions& options, const ArmBelief& belief, bool camera_free);

/// Deviations of each joint's twist xi = Ad(exp(eta)) xi_0, eta = B beta, from the covariance of beta: d xi = -ad(xi) K(eta) B d beta.
std::vector<Vector6d> twistDeviations(const Arm& nominal, const Eigen::VectorXd& beta, const Arm& arm, const Eigen::MatrixXd& covariance);

/// Prior of the camera's parameters: its stated standard deviations, or, where it states none, widths that only keep a short capture from
/// absurd lenses: 3 % of the focal length, 3 % of the width, and 0.5 for distortion coefficients (0.02 for tangential ones).
Eigen::VectorXd cameraPrior(const Camera& camera);
bool statesDeviations(const Camera& camera);

}  // namespace poecal
