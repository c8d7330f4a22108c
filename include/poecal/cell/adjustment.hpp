// Least-squares adjustment of a cell to what was measured: one optimiser for registration, identification and diagnosis.
//
//   minimise  sum_units w |r|^2 / s^2 + sum_priors ((x - x0) / sigma)^2
//
// r are residuals in units of the stated sigma, s their common scale (estimated unless given), w robust weights. Gauss-Newton with
// Levenberg-Marquardt damping on analytic Jacobians. All rows of a sample depend on the arm, the mounts and the tool through the
// six numbers of T_camera_target alone, so a sample enters the normal equations as a 6 x 6 core, whatever its number of corners.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/cell/twist_prior.hpp"

namespace poecal {

/// Which parts of the cell may move. Their parameters, in this order:
struct FreeParameters {
  bool twists = false;      ///< beta of displaceTwists: 4 a revolute, 2 a prismatic joint [rad], [m]
  bool gamma = false;       ///< left perturbation of exp(gamma) in base, (w; v)
  bool near = false;        ///< left perturbation of T_camera_near in camera
  bool far = false;         ///< left perturbation of T_far_target in the far frame
  bool intrinsics = false;  ///< Camera::parameters()
};

/// Prior (1 sigma) of T_far_target's position about its registration while the arm is fitted too [m]: too wide to matter where data show
/// it, enough to hold it where they do not. A SCARA shows the height of its tag by the millirad that its axes are not parallel.
constexpr double kFarPosition = 0.1;

/// Motion of T_far_target from where it started, as the prior kFarPosition counts it: the v of its left perturbation.
Eigen::Vector3d farMotion(const Cell& cell, const Cell& start);

struct AdjustmentOptions {
  FreeParameters free;
  /// What is believed of the twists about the nominal arm; empty: nothing.
  TwistPrior twists = {};
  /// Factor by which the arm exceeds `twists`, at least 1; where not positive it is estimated beside the scale (updatedTolerance()).
  double tolerance = 1.0;
  /// 1 sigma of each intrinsic parameter about the cell's camera; empty or NaN: no prior there.
  Eigen::VectorXd camera_prior_sigma;
  /// 1 sigma of T_far_target's position about the cell's own [m]: see kFarPosition. 0: no prior.
  double far_position = 0.0;
  /// Redescending weights: 1 up to the residual that one unit in 10^4 exceeds by chance, falling to 0 at twice that.
  bool robust = true;
  /// The scale s; estimated where not positive.
  double scale = 0.0;
  int max_iterations = 200;  ///< Gauss-Newton steps in all
};

/// One step of the iteration, for the record.
struct AdjustmentStep {
  double cost = 0.0;   ///< the function above, with the weights and the scale of this step
  double rms = 0.0;    ///< sqrt(sum w |r|^2 / sum w), r in units of the stated sigma, per unit (not per number)
  double scale = 0.0;  ///< s
};

enum class AdjustmentStatus { kNotRun, kConverged, kIterationLimit };

struct Adjustment {
  AdjustmentStatus status = AdjustmentStatus::kNotRun;
  Cell cell;                       ///< adjusted
  Eigen::VectorXd beta;            ///< twist displacements from the nominal arm; empty where the twists were held
  std::vector<std::string> names;  ///< of the free parameters
  Eigen::VectorXd sigma_prior;  ///< 1 sigma of their priors by themselves, as wide as `tolerance` makes them; infinity where there is none
  Eigen::MatrixXd covariance;   ///< of the free parameters; directions that nothing determines have zero variance and are listed below
  std::vector<AdjustmentStep> steps;         ///< the first entry is the start
  double scale = 0.0;                        ///< s, estimated or given
  double tolerance = 1.0;                    ///< factor by which the arm exceeds its tolerances, estimated or given
  double chi_square = 0.0;                   ///< sum w |r|^2 at the stated sigmas
  double degrees_of_freedom = 0.0;           ///< numbers used less the parameters that the data (not the priors) determine
  int rank = 0;                              ///< of the free parameters, with the priors
  double condition_number = 0.0;             ///< of the Jacobian with columns scaled to unit length, over the directions of `rank`
  std::vector<std::vector<double>> weights;  ///< per observation and unit, 0..1
  /// Unobservable directions: those that the data show no better than their prior, each as the names that carry it.
  std::vector<std::string> unseen;

  double reducedChiSquare() const { return degrees_of_freedom > 0.0 ? chi_square / degrees_of_freedom : 0.0; }
};

/// @param nominal  the cell to start from; its arm is what the priors of the twists are about.
/// @throws InsufficientData: fewer numbers than free parameters without priors. @throws InvalidArgument: twists or gamma free without an
/// arm, intrinsics free without a camera, q.size() not the number of joints.
Adjustment adjust(const Cell& nominal, const std::vector<Observation>& observations, const AdjustmentOptions& options);

/// A unit's residual in a cell: px (2), or (rad; m) (6), or m (3); NaN where the point cannot be projected.
struct UnitResidual {
  Eigen::VectorXd residual;   ///< measured - model, not divided by anything
  double squared_norm = 0.0;  ///< in units of the stated sigma; infinity where it cannot be projected
};

/// Residuals of an observation, one per unit.
std::vector<UnitResidual> residuals(const Cell& cell, const Observation& observation);

/// The flange as the cell models it: its arm at q, or the controller's pose where it has no arm.
Eigen::Isometry3d modelFlange(const Cell& cell, const Observation& observation);

/// Covariance of the left perturbation (camera frame) of T_camera_target at joints q, from the covariance of an adjustment.
Matrix6d targetPoseCovariance(const Adjustment& adjustment, const Cell& nominal, const FreeParameters& free, const Observation& at);

}  // namespace poecal
