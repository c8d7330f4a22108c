#include "poecal/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "identification/fit.hpp"
#include "identification/remarks.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/parallel.hpp"
#include "poecal/core/statistics.hpp"
#include "registration/consensus.hpp"
#include "registration/plausibility.hpp"

namespace poecal {
namespace {

// Up to here every pose is worth more as a judge of its own than as one fifth of a set.
constexpr std::size_t kFewPoses = 25;

struct Fold {
  std::vector<std::size_t> train, test;
};

std::vector<Fold> makeFolds(const std::vector<std::vector<std::size_t>>& groups, const IdentifyOptions& options, bool leave_one_out) {
  std::vector<Fold> folds;
  if (!leave_one_out && options.hold_out_every <= 0) return folds;
  const std::size_t count = leave_one_out ? groups.size() : static_cast<std::size_t>(options.hold_out_every);
  for (std::size_t fold = 0; fold < count; ++fold) {
    Fold split;
    for (std::size_t k = 0; k < groups.size(); ++k) {
      const bool held_out = k % count == fold;
      std::vector<std::size_t>& side = held_out ? split.test : split.train;
      side.insert(side.end(), groups[k].begin(), groups[k].end());
    }
    std::sort(split.train.begin(), split.train.end());
    std::sort(split.test.begin(), split.test.end());
    if (!split.test.empty()) folds.push_back(std::move(split));
  }
  return folds;
}

void requireMovingJoints(const Arm& arm, const std::vector<Observation>& observations, bool allowed, std::vector<std::string>& warnings) {
  for (int k = 0; k < arm.jointCount(); ++k) {
    double lower = observations.front().q(k), upper = lower;
    for (const Observation& observation : observations) {
      lower = std::min(lower, observation.q(k));
      upper = std::max(upper, observation.q(k));
    }
    if (upper - lower > 1e-4) continue;
    const std::string message = fmt::format("joint {} ({}) never moved: q{} is {:.6g} in every row", k + 1,
                                            arm.joints[static_cast<std::size_t>(k)].name, k + 1, lower);
    if (!allowed) throw InsufficientData(message + ", so that its axis cannot be identified (--allow-still-joints keeps the nominal one)");
    warnings.push_back(message + "; its axis stays nominal");
  }
}

void requireEnoughPoses(const Arm& arm, std::size_t poses, bool position_only) {
  const int unknowns = twistParameterCount(arm) + 6;
  const int per_pose = position_only ? 3 : 6;
  if (static_cast<int>(poses) * per_pose < unknowns + per_pose) {
    throw InsufficientData(fmt::format("{} poses give {} numbers for the {} unknowns of this arm: take at least {} poses", poses,
                                       static_cast<int>(poses) * per_pose, unknowns, unknowns / per_pose + 2));
  }
}

/// Everything that one choice of camera gives: the final fit, and how folds judged it.
struct Judged {
  MethodFit fit;
  std::vector<ModelStage> stages;
  std::vector<double> held_out_squares;  ///< per held-out observation, in the order of `held_out`
  std::vector<std::size_t> held_out;
};

class Identifier {
 public:
  Identifier(const Cell& cell, const Measurements& measurements, const IdentifyOptions& options, const RegistrationResult* registration)
      : cell_(cell),
        observations_(measurements.observations),
        groups_(measurements.poseGroups()),
        sigmas_stated_(measurements.sigmas_stated),
        options_(options),
        given_registration_(registration) {
    cell_.registration.setup = measurements.setup;
    belief_ = armBelief(cell_, options_);
  }

  Identification run() {
    result_.method = options_.method;
    result_.nominal = *cell_.arm;
    result_.poses = static_cast<int>(observations_.size());
    if (observations_.empty()) throw InsufficientData("nothing was measured: no pose to identify the arm from");
    corners_ = !observations_.front().pose;
    requireEnoughPoses(*cell_.arm, groups_.size(), !corners_ && observations_.front().pose->position_only);
    requireMovingJoints(*cell_.arm, observations_, options_.allow_still_joints, result_.warnings);
    registerAll();
    if (!corners_ && !sigmas_stated_ && !observations_.front().pose->position_only) estimatePoseSigmas();
    result_.leave_one_out = options_.leave_one_out || (options_.hold_out_every > 0 && groups_.size() <= kFewPoses);
    folds_ = makeFolds(groups_, options_, result_.leave_one_out);
    registerFolds();
    Choice choice = chooseCamera();
    if (choice.stated) {
      Identification stated = result_;
      stated.camera_refitted = false;
      report(std::move(*choice.stated), stated);
      stated.stages.back().name += ", lens as stated";
      result_.with_stated_camera = std::make_shared<const Identification>(std::move(stated));
    }
    result_.warnings.insert(result_.warnings.end(), choice.warnings.begin(), choice.warnings.end());
    report(std::move(choice.judged), result_);
    requireExplained(*cell_.arm, observations_, result_.stages.back().calibration);
    return std::move(result_);
  }

 private:
  void registerAll() {
    registered_ = cell_;
    if (options_.registered) {
      closed_form_ = registered_.registration = Registration{};
      requireRegistered(registered_, observations_);
    } else if (corners_) {
      RegistrationResult registration =
          given_registration_ != nullptr ? *given_registration_
                                         : registerCell(cell_, observations_, {.robust = options_.robust, .progress = options_.progress});
      registered_ = registration.cell;
      closed_form_ = registration.closed_form;
      samples_ = std::move(registration.samples);
      registration_deviation_ = registration.adjustment.covariance.diagonal().cwiseSqrt();
      // Of corners without noise something far below what any picture has.
      corner_noise_ = std::max(registration.corner_scale, 1e-6);
      result_.warnings.insert(result_.warnings.end(), registration.warnings.begin(), registration.warnings.end());
    } else {
      const PoseRegistration registration = registerPoses(cell_, observations_, options_.robust);
      registered_ = registration.adjustment.cell;
      closed_form_ = registered_.registration;
      registration_deviation_ = registration.adjustment.covariance.diagonal().cwiseSqrt();
      result_.warnings.insert(result_.warnings.end(), registration.warnings.begin(), registration.warnings.end());
    }
    prepareFlangePoses();
  }

  void prepareFlangePoses() {
    if (options_.method != Method::kBundle) flange_ = flangePoses(registered_, observations_, corners_ ? &samples_ : nullptr);
  }

  /// An instrument that states no deviations: those of rotation and position from the residuals, by turns with the fit.
  void estimatePoseSigmas() {
    std::vector<std::size_t> all(observations_.size());
    std::iota(all.begin(), all.end(), 0);
    IdentifyOptions plain = options_;
    plain.method = Method::kBundle;
    double sigma_rotation = 0.0, sigma_position = 0.0;
    for (int round = 0; round < 20; ++round) {
      const MethodFit fit = fitMethod(registered_, observations_, flange_, all, plain, belief_, false);
      std::vector<double> rotations, positions;
      for (const Observation& observation : observations_) {
        const Eigen::VectorXd e = residuals(fit.cell, observation).front().residual;
        rotations.push_back(e.head<3>().squaredNorm());
        positions.push_back(e.tail<3>().squaredNorm());
      }
      // The fit takes its unknowns out of the residuals: half from rotations, half from positions.
      const double numbers = 3.0 * static_cast<double>(observations_.size());
      const double spare = std::max(0.25 * numbers, numbers - 0.5 * (twistParameterCount(*cell_.arm) + 12.0));
      const double factor = std::sqrt(numbers / spare / chiSquareQuantile(0.5, 3));
      const double rotation = std::max(1e-12, factor * std::sqrt(median(rotations)));
      const double position = std::max(1e-12, factor * std::sqrt(median(positions)));
      const bool settled = std::abs(rotation - sigma_rotation) < 1e-3 * rotation && std::abs(position - sigma_position) < 1e-3 * position;
      sigma_rotation = rotation;
      sigma_position = position;
      Vector6d weight;
      weight << Eigen::Vector3d::Constant(1.0 / rotation), Eigen::Vector3d::Constant(1.0 / position);
      for (Observation& observation : observations_) observation.pose->whitening = weight.asDiagonal();
      if (!options_.registered) registered_ = registerFrom(registered_, all);
      prepareFlangePoses();
      if (settled) break;
    }
    sigma_rotation_ = sigma_rotation;
    sigma_position_ = sigma_position;
  }

  /// The registration of the nominal arm on some observations, started from one that is near.
  Cell registerFrom(const Cell& start, const std::vector<std::size_t>& subset) const {
    if (options_.registered) return start;
    std::vector<Observation> some;
    for (const std::size_t k : subset) some.push_back(observations_[k]);
    return adjust(start, some, registrationAdjustment(options_.robust)).cell;
  }

  /// The fold registrations, which do not depend on the camera's choice.
  void registerFolds() {
    registered_of_fold_.assign(folds_.size(), registered_);
    Progress progress(options_.progress, "registering without held-out poses", folds_.size());
    progress.show();
    parallelFor(folds_.size(), options_.jobs, [&](std::size_t k) {
      registered_of_fold_[k] = registerFrom(registered_, folds_[k].train);
      progress.advance();
    });
  }

  Judged judge(bool camera_free) const {
    std::vector<std::size_t> all(observations_.size());
    std::iota(all.begin(), all.end(), 0);
    // One of all poses, then one of each fold.
    std::vector<MethodFit> fits(1 + folds_.size());
    Progress progress(options_.progress, camera_free ? "fitting arm and lens" : "fitting the arm", fits.size());
    progress.show();
    fits[0] = fitMethod(registered_, observations_, flange_, all, options_, belief_, camera_free);
    progress.advance();
    // One number for the whole arm, which a fifth of the poses hardly moves.
    const ArmBelief known{belief_.twists, fits[0].adjustment.tolerance};
    parallelFor(folds_.size(), options_.jobs, [&](std::size_t k) {
      fits[k + 1] = fitMethod(registered_, observations_, flange_, folds_[k].train, options_, known, camera_free);
      progress.advance();
    });
    Judged judged;
    judged.fit = std::move(fits.front());
    Cell nominal = registered_;
    nominal.registration = closed_form_;
    const auto collector = [this] { return ErrorCollector(corner_noise_); };
    ErrorCollector calibration[3] = {collector(), collector(), collector()}, test[3] = {collector(), collector(), collector()};
    const auto collect = [&](const Cell& cell, const std::vector<std::size_t>& subset, ErrorCollector& errors) {
      for (const std::size_t k : subset) errors.add(cell, k, observations_[k]);
    };
    for (std::size_t fold = 0; fold < folds_.size(); ++fold) {
      const Cell* cells[3] = {&nominal, &registered_of_fold_[fold], &fits[fold + 1].cell};
      for (int stage = 0; stage < 3; ++stage) collect(*cells[stage], folds_[fold].test, test[stage]);
    }
    const Cell* cells[3] = {&nominal, &registered_, &judged.fit.cell};
    for (int stage = 0; stage < 3; ++stage) collect(*cells[stage], all, calibration[stage]);
    const auto kept = [&](std::size_t k) { return !leftOut(judged.fit, k); };
    const char* names[3] = {"nominal", "registered", "identified"};
    for (int stage = 0; stage < 3; ++stage) {
      judged.stages.push_back(
          {names[stage], calibration[stage].summary(), test[stage].summary(), test[stage].summary(kept), test[stage].rows()});
    }
    for (const RowErrors& row : test[2].rows()) {
      if (!kept(row.index)) continue;
      judged.held_out.push_back(row.index);
      judged.held_out_squares.push_back(row.whitened_squares);
    }
    return judged;
  }

  bool leftOut(const MethodFit& fit, std::size_t k) const {
    if (!fit.adjustment.weights.empty()) return keptShare(fit.adjustment.weights[k]) < 0.5;
    return corners_ && !samples_.empty() && samples_[k].left_out;
  }

  /// The fit that was chosen, what is to be said of it, and the fit with the camera as stated where that was given up.
  struct Choice {
    Judged judged;
    std::vector<std::string> warnings = {};
    std::optional<Judged> stated = std::nullopt;
  };

  Choice chooseCamera() {
    const bool movable = corners_ && options_.method == Method::kBundle;
    if (!movable || options_.camera == CameraChoice::kStated) return {judge(false)};
    if (options_.camera == CameraChoice::kFree || statesDeviations(*cell_.camera)) {
      Choice choice;
      if (!statesDeviations(*cell_.camera)) choice.stated = judge(false);
      choice.judged = judge(true);
      result_.camera_refitted = true;
      const std::string moved = lensMoveWarning(choice.judged.fit, *cell_.camera);
      if (!moved.empty()) choice.warnings.push_back(moved);
      return choice;
    }
    Judged stated = judge(false);
    if (folds_.empty()) return {std::move(stated)};
    Judged freed = judge(true);
    if (!clearlyBetter(freed, stated)) return {std::move(stated)};
    result_.camera_refitted = true;
    const double before = stated.stages.back().held_out_kept.px.rms, after = freed.stages.back().held_out_kept.px.rms;
    const std::string said =
        fmt::format("{} with the camera re-fitted ({}) the error on poses that the fit did not see falls from {:.2f} to {:.2f} px rms",
                    fitsAsFreePoses(after) ? "the stated lens is wrong:"
                                           : "the stated lens may be wrong, or another one stands in for some other effect:",
                    lensMoveText(freed.fit, *cell_.camera), before, after);
    return {std::move(freed), {said}, std::move(stated)};
  }

  /// Whether so many pixels are about what pictures leave with poses of their own, which follow what little noise they can.
  bool fitsAsFreePoses(double px) const {
    constexpr double kAbout = 6.0;
    std::vector<double> free;
    for (const RegisteredSample& sample : samples_) free.push_back(sample.free_rms_px);
    return !free.empty() && px <= kAbout * median(std::move(free));
  }

  /// Paired over poses that both judged: a drop of the rms by a fifth that is also 2.6 standard errors (1 %, two-sided) above none.
  static bool clearlyBetter(const Judged& freed, const Judged& stated) {
    std::map<std::size_t, double> before;
    for (std::size_t k = 0; k < stated.held_out.size(); ++k) before[stated.held_out[k]] = stated.held_out_squares[k];
    std::vector<double> gains;
    double sum_before = 0.0, sum_after = 0.0;
    for (std::size_t k = 0; k < freed.held_out.size(); ++k) {
      const auto found = before.find(freed.held_out[k]);
      if (found == before.end()) continue;
      gains.push_back(found->second - freed.held_out_squares[k]);
      sum_before += found->second;
      sum_after += freed.held_out_squares[k];
    }
    if (gains.size() < 4 || !(sum_after < 0.64 * sum_before)) return false;
    const double centre = mean(gains);
    double spread = 0.0;
    for (const double gain : gains) spread += (gain - centre) * (gain - centre);
    const auto count = static_cast<double>(gains.size());
    return centre > 2.6 * std::sqrt(spread / (count * (count - 1.0)));
  }

  void report(Judged judged, Identification& result) const {
    const MethodFit& fit = judged.fit;
    result.stages = std::move(judged.stages);
    result.corner_noise = corner_noise_;
    for (const Fold& fold : folds_) result.folds.push_back(fold.test);
    result.held_out_poses = result.stages.back().held_out.poses;
    result.status = fit.converged ? AdjustmentStatus::kConverged : AdjustmentStatus::kIterationLimit;
    if (!fit.converged) result.warnings.push_back("the fit reached its iteration limit: its figures are not those of a minimum");
    result.steps = fit.adjustment.steps;
    result.gao_residuals = fit.gao_residuals;
    result.parameter_names = fit.parameter_names;
    result.parameter_deviation = fit.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    result.rank = fit.adjustment.rank;
    result.condition_number = fit.adjustment.condition_number;
    result.unseen = fit.adjustment.unseen;
    result.sigmas_stated = sigmas_stated_;
    result.scale = fit.adjustment.scale;
    const std::string stated = sigmas_stated_ ? statedDeviationsWarning(result.scale, corners_) : "";
    if (!stated.empty()) result.warnings.push_back(stated);
    const std::string mixed = sigmas_stated_ ? mixedDeviationsWarning(fit.cell, observations_) : "";
    if (!mixed.empty()) result.warnings.push_back(mixed);
    result.reduced_chi_square = fit.adjustment.reducedChiSquare();
    result.degrees_of_freedom = fit.adjustment.degrees_of_freedom;
    if (!corners_) {
      const double scale = fit.adjustment.scale > 0.0 ? fit.adjustment.scale : 1.0;
      result.sigma_position = scale * sigma_position_;
      result.sigma_rotation = scale * sigma_rotation_;
    }
    for (Eigen::Index k = 0; k < fit.adjustment.sigma_prior.size(); ++k) {
      const double prior = fit.adjustment.sigma_prior(k);
      result.prior_share.push_back(std::isfinite(prior) ? std::pow(result.parameter_deviation(k) / prior, 2) : 0.0);
    }
    result.arm_beyond_tolerance = fit.adjustment.tolerance;
    result.twist_prior = belief_.twists;
    if (!belief_.twists.empty() && fit.adjustment.beta.size() > 0) {
      result.joint_deviations = belief_.twists.deviations(fit.adjustment.beta);
      const std::vector<std::string> far = deviationWarnings(*cell_.arm, result.joint_deviations, options_);
      result.warnings.insert(result.warnings.end(), far.begin(), far.end());
    }
    const bool flange = options_.method == Method::kWeighted;
    result.suspects = suspectRows(fit, flange ? fit.adjustment.cell : fit.cell, flange ? flange_.observations : observations_);
    result.gauge = gaugeRemarks(*cell_.arm, fit, options_.registered);
    Model& model = result.model;
    model.cell = fit.cell;
    model.method = methodName(options_.method);
    model.deviation.twists = fit.twist_deviation;
    model.deviation.gamma = fit.gamma_deviation;
    setTransformDeviations(fit, model);
    result.adjustment = fit.adjustment;
    result.free = fit.free;
    result.start = fit.start;
    result.closed_form = closed_form_;
  }

  void setTransformDeviations(const MethodFit& fit, Model& model) const {
    if (options_.registered) return;
    Eigen::VectorXd both = registration_deviation_;
    if (fit.free.near && fit.free.far) both = fit.covariance.diagonal().segment<12>(fit.adjustment.beta.size()).cwiseSqrt();
    if (both.size() != 12) return;
    model.deviation.T_camera_near = both.head<6>();
    model.deviation.T_far_target = both.tail<6>();
    if (fit.free.intrinsics) {
      model.cell.camera->standard_deviation = fit.covariance.diagonal().tail(fit.cell.camera->parameterCount()).cwiseSqrt();
    }
  }

  Cell cell_;
  std::vector<Observation> observations_;
  std::vector<std::vector<std::size_t>> groups_;
  bool sigmas_stated_;
  IdentifyOptions options_;
  const RegistrationResult* given_registration_;
  ArmBelief belief_;
  Identification result_;
  bool corners_ = true;
  Cell registered_;
  Registration closed_form_;
  std::vector<RegisteredSample> samples_;
  Eigen::VectorXd registration_deviation_;
  FlangePoses flange_;
  std::vector<Fold> folds_;
  std::vector<Cell> registered_of_fold_;
  double sigma_position_ = 0.0, sigma_rotation_ = 0.0;
  double corner_noise_ = 1.0;  ///< standard deviation of corners in their stated sigmas, from free poses of the target
};

}  // namespace

const char* methodName(Method method) {
  switch (method) {
    case Method::kGao:
      return "gao";
    case Method::kWeighted:
      return "weighted";
    case Method::kBundle:
      return "bundle";
  }
  return "";
}

Method methodFromName(const std::string& name) {
  for (const Method method : {Method::kGao, Method::kWeighted, Method::kBundle}) {
    if (name == methodName(method)) return method;
  }
  throw InvalidArgument(fmt::format("method '{}', expected gao, weighted or bundle", name));
}

void IdentifyOptions::validate() const {
  if (!(tolerance_position >= 0.0)) throw InvalidArgument("tolerance_position must not be negative");
  if (!(tolerance_rotation >= 0.0)) throw InvalidArgument("tolerance_rotation must not be negative");
  if (hold_out_every < 0 || hold_out_every == 1) throw InvalidArgument("hold_out_every must be 0 or at least 2");
}

Identification identify(const Cell& cell, const Measurements& measurements, const IdentifyOptions& options,
                        const RegistrationResult* registration) {
  options.validate();
  if (!cell.arm) throw InvalidArgument("identification needs an arm");
  Identification result = Identifier(cell, measurements, options, registration).run();
  result.model.gravity = measurements.gravity;
  return result;
}

}  // namespace poecal
