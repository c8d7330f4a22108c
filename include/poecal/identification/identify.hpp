// Identification of the arm: gao, weighted and bundle behind one pair of options and result.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "poecal/cell/adjustment.hpp"
#include "poecal/cell/measurements.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/identification/errors.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/registration/registration.hpp"

namespace poecal {

/// gao: the algorithm of Gao, Wang and Jiang (2013) on measured flange poses, unweighted.
/// weighted: the same unknowns, each pose weighted by its covariance.
/// bundle: the measurements themselves (corners, or poses of an instrument), with both transforms around the arm free.
enum class Method { kGao, kWeighted, kBundle };
const char* methodName(Method method);
/// @throws InvalidArgument for another name.
Method methodFromName(const std::string& name);

/// Whether `bundle` may move the camera: never; always; or where the camera file states standard deviations (they are the prior) and,
/// where it states none, if the poses that the fit did not see are then clearly better predicted.
enum class CameraChoice { kStated, kFree, kAuto };

struct IdentifyOptions {
  Method method = Method::kBundle;
  /// Tolerances to which the arm is made, 1 sigma: of an axis' place [m] and tilt [rad], as TwistPrior has them. How far this arm exceeds
  /// them is estimated. Both 0: no prior; one of them 0: a width of 1 m or 1 rad there.
  double tolerance_position = 1e-3;
  double tolerance_rotation = 3e-3;
  CameraChoice camera = CameraChoice::kAuto;
  bool robust = true;
  double gao_length_unit = 1.0;  ///< gao only: unit of length [m] that its unweighted rows mix with radians; the paper's is 1e-3
  /// Number n of cross-validation folds: every n-th pose is held out to judge a fit, in n turns, so that each pose judges once; 0: none.
  /// The model itself is fitted to all poses.
  int hold_out_every = 5;
  /// Each pose is held out alone instead. Automatic where there are at most 25 poses.
  bool leave_one_out = false;
  bool registered = false;          ///< poses are T_base_flange already: both transforms are identity
  int jobs = 1;                     ///< fits worked on at a time (0: one per core); the result does not depend on it
  bool allow_still_joints = false;  ///< a joint that never moved keeps its nominal axis instead of being an error
  ProgressFunction progress = {};   ///< told of each fit; may be empty
  void validate() const;
};

/// A row that the model contradicts.
struct SuspectRow {
  std::size_t sample = 0;
  double residual = 0.0;  ///< rms of its corners [px]; for poses the distance [m]
  double sigmas = 0.0;    ///< largest residual of a unit in standard deviations of the fit
  bool left_out = false;  ///< most of it had no weight
};

/// One model stage: "nominal" (the nominal arm with a closed-form registration), "registered", "identified".
struct ModelStage {
  std::string name;
  ErrorSummary calibration;              ///< every row, by the fit to all of them
  ErrorSummary held_out;                 ///< every row, each by a fit that did not see its pose
  ErrorSummary held_out_kept;            ///< of these, without the rows that the fit set aside as contradicting all others
  std::vector<RowErrors> held_out_rows;  ///< each row of held_out, by its observation
};

struct Identification {
  Method method = Method::kBundle;
  Model model;
  Arm nominal;
  std::vector<AdjustmentStep> steps;  ///< of the final fit
  std::vector<double> gao_residuals;  ///< RMS of y before each step, rad and gao_length_unit mixed as the paper has it; gao only
  AdjustmentStatus status = AdjustmentStatus::kNotRun;
  std::vector<ModelStage> stages;
  std::vector<SuspectRow> suspects;
  int poses = 0;           ///< observations used
  int held_out_poses = 0;  ///< of these, poses that judged a fit which did not see them
  bool leave_one_out = false;
  std::vector<std::vector<std::size_t>> folds;  ///< observations that were held out together, in turn; empty where none was
  // Noise and fit
  double corner_noise = 1.0;  ///< standard deviation of corners in their stated sigmas, from free poses of the target
  bool sigmas_stated = false;
  double scale = 0.0;               ///< of the stated sigmas; the sigma itself [px] where corners state none
  double sigma_position = 0.0;      ///< estimated, per axis [m]; poses only
  double sigma_rotation = 0.0;      ///< estimated, per axis [rad]; poses only
  double reduced_chi_square = 0.0;  ///< at the stated sigmas
  double degrees_of_freedom = 0.0;
  double arm_beyond_tolerance = 1.0;             ///< factor by which the arm exceeds its tolerances, estimated, at least 1
  TwistPrior twist_prior;                        ///< of those tolerances; empty where there is no prior
  std::vector<JointDeviation> joint_deviations;  ///< what the prior makes of the identified arm; empty without one
  // Observability
  std::vector<std::string> parameter_names;
  Eigen::VectorXd parameter_deviation;  ///< standard deviations
  std::vector<double> prior_share;      ///< share of each parameter's variance reduction that is owed to its prior, 0..1
  int rank = 0;
  double condition_number = 0.0;
  std::vector<std::string> unseen;
  std::vector<std::string> gauge;  ///< what no data of this kind can tell, by name, and how it was fixed
  bool camera_refitted = false;
  std::vector<std::string> warnings;
  // To predict uncertainty
  Adjustment adjustment;  ///< of the final fit (weighted, bundle)
  FreeParameters free;
  Cell start;                ///< what the priors are about
  Registration closed_form;  ///< of the nominal arm, before anything was fitted
  /// The same with the camera held as stated, where it was re-fitted though no deviations are stated: what a diagnosis starts from.
  std::shared_ptr<const Identification> with_stated_camera;
};

/// Identifies the arm of `cell` from measurements (corners of a capture, or poses of an instrument).
///
/// @param cell  nominal arm, and camera where observations are corners. Its registration is ignored; the setup is that of the measurements.
/// @param registration  of these measurements in this cell, where it was done already; otherwise it is done here.
/// @throws InsufficientData: too few poses for the unknowns, a joint that never moved, no registration.
/// @throws ImplausibleCapture: as registerCell(); or the identified arm still puts the flange half of the poses' spread, or 1 rad, from
/// where it was measured.
Identification identify(const Cell& cell, const Measurements& measurements, const IdentifyOptions& options = {},
                        const RegistrationResult* registration = nullptr);

/// identification.json.
std::string identificationJson(const Identification& identification, const std::vector<Sample>& samples);

}  // namespace poecal
