// `bundle` as one would write it in Ceres with automatic derivatives: the same residuals, priors and parameters.
#pragma once

#include <vector>

#include "poecal/cell/adjustment.hpp"

namespace poecal::benchmarks {

/// Where the fit ended.
struct CeresBundle {
  Eigen::VectorXd beta;  ///< twist displacements, as Adjustment::beta
  Registration registration;
  Eigen::VectorXd camera;  ///< Camera::parameters()
  int iterations = 0;
  bool converged = false;
};

/// Plain least squares over the twists, both transforms and, where free, the intrinsics of a plumb_bob camera.
/// @param start  revolute joints only, eye_to_hand. @param options  its priors and free.intrinsics; the scale is 1.
CeresBundle solveWithCeres(const Cell& start, const std::vector<Observation>& observations, const AdjustmentOptions& options);

}  // namespace poecal::benchmarks
