#include "poecal/registration/registration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>
#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/registration/hand_eye.hpp"
#include "poecal/registration/target_pose.hpp"
#include "registration/hypotheses.hpp"
#include "registration/plausibility.hpp"

namespace poecal {
namespace {

Eigen::Isometry3d nearFar(const Cell& cell, const Observation& observation) {
  const Eigen::Isometry3d T_base_flange = modelFlange(cell, observation);
  return cell.registration.setup == Setup::kEyeToHand ? T_base_flange : T_base_flange.inverse();
}

double cornerRms(const Cell& cell, const Observation& observation) {
  double sum = 0.0;
  for (const UnitResidual& unit : residuals(cell, observation)) sum += unit.residual.squaredNorm();
  const double rms = std::sqrt(sum / std::max(1, observation.unitCount()));
  return std::isnan(rms) ? std::numeric_limits<double>::infinity() : rms;
}

/// Of an observation where the arm is at T_near_far; the search asks this hundreds of times of each, so it does not go through the arm
/// again.
double misfitOf(const Cell& cell, const Registration& registration, const Eigen::Isometry3d& T_near_far, const Observation& observation) {
  if (!observation.pose) {
    const Eigen::Isometry3d T_camera_target = registration.T_camera_near * T_near_far * registration.T_far_target;
    double sum = 0.0;
    for (const CornerMeasurement& corner : observation.corners) {
      const std::optional<Eigen::Vector2d> px = project(*cell.camera, T_camera_target * corner.p_target);
      if (!px) return std::numeric_limits<double>::infinity();
      sum += (corner.px - *px).squaredNorm();
    }
    return std::sqrt(sum / std::max(1, observation.unitCount()));
  }
  Cell trial = cell;
  trial.registration = registration;
  double sum = 0.0;
  for (const UnitResidual& unit : residuals(trial, observation)) sum += unit.squared_norm;
  return std::sqrt(sum);
}

AdjustmentOptions registrationAdjustment(bool robust) {
  AdjustmentOptions options;
  options.free.near = true;
  options.free.far = true;
  options.robust = robust;
  return options;
}

std::vector<HypothesisSample> cornerHypotheses(const Cell& cell, const std::vector<Observation>& observations) {
  std::vector<HypothesisSample> samples;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    HypothesisSample sample;
    sample.observation = k;
    sample.T_near_far = nearFar(cell, observations[k]);
    for (const TargetPose& pose : targetPoses(*cell.camera, observations[k])) sample.candidates.push_back(pose.T_camera_target);
    samples.push_back(std::move(sample));
  }
  return samples;
}

/// Misfit that 60 % of the samples stay below, after a closed form; infinity where there is none.
double agreeingMisfit(const Cell& cell, const std::vector<Observation>& observations) {
  const std::vector<HypothesisSample> samples = cornerHypotheses(cell, observations);
  const Misfit misfit = [&](const Registration& registration, const HypothesisSample& sample) {
    return misfitOf(cell, registration, sample.T_near_far, observations[sample.observation]);
  };
  const std::vector<Hypothesis> found = searchRegistrations(cell.registration.setup, samples, misfit, 100);
  return found.empty() ? std::numeric_limits<double>::infinity() : found.front().score;
}

// Above this number robust weights have enough good pictures to lean on, and judging one by one would take long.
constexpr std::size_t kJudgedOneByOne = 60;

/// A nominal arm is off by a per cent or two of the picture; a registration that leaves more than a twelfth of it is none.
void requirePlausible(const Cell& cell, const std::vector<Observation>& observations, const Adjustment& fit) {
  std::vector<double> misfits;
  for (const Observation& observation : observations) misfits.push_back(cornerRms(fit.cell, observation));
  const double misfit = quantile(misfits, 0.6);
  if (misfit < cell.camera->width / 12.0) return;
  const std::optional<std::string> suspicion = suspectedMistake(cell, observations, misfit, agreeingMisfit);
  throw ImplausibleInput(fmt::format(
      "no registration explains most of the pictures (the best leaves {:.0f} px): {}", misfit,
      suspicion ? "suspected are " + *suspicion
                : std::string("expected joint readings, robot and pictures that belong together (units, signs, order of the rows)")));
}

/// The best of the refined hypotheses. Which is best shows on some of the samples; only that one is refined on all of them.
Adjustment adjustBest(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                      int hypotheses, bool robust, Registration* closed_form = nullptr) {
  const Misfit misfit = [&](const Registration& registration, const HypothesisSample& sample) {
    return misfitOf(cell, registration, sample.T_near_far, observations[sample.observation]);
  };
  const std::vector<Hypothesis> found = searchRegistrations(cell.registration.setup, samples, misfit, hypotheses);
  if (found.empty()) {
    throw InsufficientData("no registration follows from these poses: the target must be seen in at least three different orientations");
  }
  constexpr std::size_t kCompared = 300;
  const std::size_t stride = (observations.size() + kCompared - 1) / kCompared;
  std::vector<Observation> some;
  for (std::size_t k = 0; k < observations.size(); k += stride) some.push_back(observations[k]);
  std::optional<Adjustment> best;
  double best_misfit = std::numeric_limits<double>::infinity();
  for (const Hypothesis& hypothesis : found) {
    Cell start = cell;
    start.registration = hypothesis.registration;
    Adjustment fit = adjust(start, some, registrationAdjustment(robust));
    std::vector<double> misfits;
    for (std::size_t k = 0; k < samples.size(); k += stride) misfits.push_back(misfit(fit.cell.registration, samples[k]));
    const double of_most = quantile(std::move(misfits), 0.6);
    if (!best || of_most < best_misfit * (1.0 - 1e-9)) {
      best_misfit = of_most;
      best = std::move(fit);
      if (closed_form != nullptr) *closed_form = hypothesis.registration;
    }
  }
  return stride == 1 ? *best : adjust(best->cell, observations, registrationAdjustment(robust));
}

void requireTurning(const Cell& cell, const std::vector<Observation>& observations) {
  std::vector<Eigen::Isometry3d> poses;
  for (const Observation& observation : observations) poses.push_back(nearFar(cell, observation));
  if (rotationDirections(poses) == 0) {
    throw InsufficientData("the arm never turned the flange by more than half a degree: registration needs poses of different orientation");
  }
}

/// Sum of squares of one picture's corners in a cell, at the stated sigmas.
double squareSum(const Cell& cell, const Observation& observation) {
  double sum = 0.0;
  for (const UnitResidual& unit : residuals(cell, observation)) sum += unit.squared_norm;
  return sum;
}

/// The picture whose removal explains more than chance: F test of the six numbers of its pose against the scatter of the others, at 1 %
/// over all pictures. Nothing where no picture stands out.
std::optional<std::size_t> contradictedPicture(const Adjustment& fit, const std::vector<Observation>& observations,
                                               const std::vector<bool>& out) {
  std::vector<std::size_t> kept;
  std::vector<std::pair<double, std::size_t>> worst;
  double total = 0.0;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    if (out[k]) continue;
    kept.push_back(k);
    const double square = squareSum(fit.cell, observations[k]);
    total += square;
    worst.emplace_back(-square, k);
  }
  // A picture's numbers count as the six of its pose: corners of one picture err together.
  const double dof = 6.0 * static_cast<double>(kept.size() - 1) - 12.0;
  if (kept.size() < 5 || dof < 6.0) return std::nullopt;
  std::sort(worst.begin(), worst.end());
  worst.resize(std::min<std::size_t>(worst.size(), 5));
  std::optional<std::size_t> found;
  double smallest = 0.01 / static_cast<double>(kept.size());
  for (const auto& [square, candidate] : worst) {
    std::vector<Observation> others;
    for (const std::size_t k : kept) {
      if (k != candidate) others.push_back(observations[k]);
    }
    const Adjustment without = adjust(fit.cell, others, registrationAdjustment(false));
    const double left = without.chi_square;
    const double p = fTail((total - left) / 6.0 / (left / dof), 6.0, dof);
    if (p < smallest) {
      smallest = p;
      found = candidate;
    }
  }
  return found;
}

void leaveOutBad(const std::vector<Observation>& observations, RegistrationResult& result, std::vector<bool>& out) {
  for (std::size_t limit = observations.size() / 4; limit > 0; --limit) {
    const std::optional<std::size_t> bad = contradictedPicture(result.adjustment, observations, out);
    if (!bad) return;
    out[*bad] = true;
    std::vector<Observation> kept;
    for (std::size_t k = 0; k < observations.size(); ++k) {
      if (!out[k]) kept.push_back(observations[k]);
    }
    result.adjustment = adjust(result.adjustment.cell, kept, registrationAdjustment(false));
    result.cell = result.adjustment.cell;
  }
}

/// The measured flange with the covariance of its corners.
void measureFlange(const Cell& cell, const Observation& observation, const std::vector<Eigen::Isometry3d>& candidates,
                   RegisteredSample& sample, double& squares, double& redundancy) {
  if (candidates.empty()) return;
  const Eigen::Isometry3d predicted = cell.registration.cameraTarget(modelFlange(cell, observation));
  const auto nearest = std::min_element(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
    return rotationAngle(predicted.linear().transpose() * a.linear()) < rotationAngle(predicted.linear().transpose() * b.linear());
  });
  const FreePose pose = refinePose(*cell.camera, observation, *nearest);
  const Registration& registration = cell.registration;
  sample.has_pose = true;
  sample.T_camera_target = pose.T_camera_target;
  sample.T_base_flange = registration.baseFlange(pose.T_camera_target);
  sample.free_rms_px = pose.rms_px;
  // Left perturbation of T_camera_target in camera -> of T_base_flange in base -> (rotation; position of the flange).
  Matrix6d toFlange = Matrix6d::Identity();
  toFlange.bottomLeftCorner<3, 3>() = -hat(sample.T_base_flange.translation());
  const Matrix6d D = toFlange * adjoint(registration.cameraBase(sample.T_base_flange).inverse());
  sample.covariance = D * pose.covariance * D.transpose();
  squares += pose.chi_square;
  redundancy += 2.0 * pose.corners - 6.0;
}

/// Root mean square of the corners' stated deviations [px].
double statedSigma(const std::vector<Observation>& observations) {
  std::vector<double> sigmas;
  for (const Observation& observation : observations) {
    for (const CornerMeasurement& corner : observation.corners) sigmas.push_back(corner.sigma_px);
  }
  return rms(sigmas);
}

}  // namespace

double keptShare(const std::vector<double>& unit_weights) { return unit_weights.empty() ? 0.0 : mean(unit_weights); }

RegistrationResult registerCell(const Cell& cell, const std::vector<Observation>& observations, const RegistrationOptions& options) {
  if (!cell.camera) throw InvalidArgument("registration from corners needs a camera");
  const std::vector<HypothesisSample> hypotheses = cornerHypotheses(cell, observations);
  const auto usable = std::count_if(hypotheses.begin(), hypotheses.end(), [](const auto& sample) { return !sample.candidates.empty(); });
  if (usable < 3) {
    throw InsufficientData(fmt::format("the target's pose is seen in {} picture{}, at least 3 are needed", usable, usable == 1 ? "" : "s"));
  }
  requireTurning(cell, observations);
  if (mirroredShare(observations) > 0.5) {
    throw ImplausibleInput(
        "the corners of most tags run clockwise in the picture, as of a flipped (mirrored) tag: expected the order bottom-left, "
        "bottom-right, "
        "top-right, top-left of the upright tag seen from its front");
  }

  RegistrationResult result;
  result.adjustment = adjustBest(cell, observations, hypotheses, options.hypotheses, options.robust, &result.closed_form);
  result.cell = result.adjustment.cell;
  requirePlausible(cell, observations, result.adjustment);
  std::vector<bool> out(observations.size(), false);
  std::optional<Cell> plain;
  const bool judged_one_by_one = options.leave_out_bad && !cell.arm && observations.size() <= kJudgedOneByOne;
  if (judged_one_by_one) {
    // Weights would find a few pictures that happen to agree; with every picture in, one is taken out only where the others demand it.
    result.adjustment = adjust(result.cell, observations, registrationAdjustment(false));
    result.cell = result.adjustment.cell;
    plain = result.cell;
    leaveOutBad(observations, result, out);
  } else {
    for (std::size_t k = 0; k < observations.size(); ++k) out[k] = keptShare(result.adjustment.weights[k]) < 0.5;
  }
  for (const std::string& direction : result.adjustment.unseen) {
    result.warnings.push_back("the registration does not determine " + direction +
                              " (the arm's motions leave it open); it is held where it started");
  }

  double used_squares = 0.0, used_corners = 0.0, all_squares = 0.0, all_corners = 0.0;
  double free_squares = 0.0, free_corners = 0.0, free_chi_square = 0.0, redundancy = 0.0;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    RegisteredSample sample;
    sample.sample = observations[k].sample;
    sample.left_out = out[k];
    sample.rms_px = cornerRms(result.cell, observations[k]);
    const double corners = observations[k].unitCount();
    if (std::isfinite(sample.rms_px)) {
      const double of_all = plain ? cornerRms(*plain, observations[k]) : sample.rms_px;
      all_squares += corners * of_all * of_all;
      all_corners += corners;
      if (!out[k]) {
        used_squares += corners * sample.rms_px * sample.rms_px;
        used_corners += corners;
      }
    }
    double chi_square = 0.0, spare = 0.0;
    measureFlange(result.cell, observations[k], hypotheses[k].candidates, sample, chi_square, spare);
    if (sample.has_pose && !out[k]) {
      free_squares += corners * sample.free_rms_px * sample.free_rms_px;
      free_corners += corners;
      free_chi_square += chi_square;
      redundancy += spare;
    }
    result.samples.push_back(std::move(sample));
  }
  result.rms_px = used_corners > 0.0 ? std::sqrt(used_squares / used_corners) : 0.0;
  result.rms_all_px = all_corners > 0.0 ? std::sqrt(all_squares / all_corners) : 0.0;
  result.free_rms_px = free_corners > 0.0 ? std::sqrt(free_squares / free_corners) : 0.0;
  result.corner_scale = redundancy > 0.0 ? std::sqrt(free_chi_square / redundancy) : 1.0;
  result.corner_sigma_px = result.corner_scale * statedSigma(observations);
  for (RegisteredSample& sample : result.samples) sample.covariance *= result.corner_scale * result.corner_scale;
  return result;
}

namespace {

/// y_i = R (R_i p + t_i) + t for positions alone: by turns R, t for a known tool point p (orthogonal Procrustes) and p, t for a known R
/// (linear).
Registration registrationFromPositions(const Cell& cell, const std::vector<Observation>& observations) {
  const auto count = static_cast<Eigen::Index>(observations.size());
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  std::vector<Eigen::Isometry3d> poses;
  Eigen::Matrix3Xd measured(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Observation& observation = observations[static_cast<std::size_t>(k)];
    poses.push_back(nearFar(cell, observation));
    measured.col(k) = observation.pose->T_camera_target.translation();
  }
  // Converges geometrically, by about the square of (tool length / spread of the poses) a round.
  for (int round = 0; round < 100; ++round) {
    Eigen::Matrix3Xd modelled(3, count);
    for (Eigen::Index k = 0; k < count; ++k) modelled.col(k) = poses[static_cast<std::size_t>(k)] * p;
    const Eigen::Matrix3Xd a = modelled.colwise() - modelled.rowwise().mean();
    const Eigen::Matrix3Xd b = measured.colwise() - measured.rowwise().mean();
    R = nearestRotation(b * a.transpose());
    Eigen::MatrixXd A(3 * count, 6);
    Eigen::VectorXd rhs(3 * count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Isometry3d& pose = poses[static_cast<std::size_t>(k)];
      A.block<3, 3>(3 * k, 0) = R * pose.linear();
      A.block<3, 3>(3 * k, 3).setIdentity();
      rhs.segment<3>(3 * k) = measured.col(k) - R * pose.translation();
    }
    const Eigen::VectorXd x = A.completeOrthogonalDecomposition().solve(rhs);
    p = x.head<3>();
    t = x.tail<3>();
  }
  Registration registration = cell.registration;
  registration.T_camera_near.linear() = R;
  registration.T_camera_near.translation() = t;
  registration.T_far_target = Eigen::Translation3d(p) * Eigen::Isometry3d::Identity();
  return registration;
}

}  // namespace

Adjustment registerPoses(const Cell& cell, const std::vector<Observation>& observations, bool robust) {
  if (observations.size() < 3) throw InsufficientData(fmt::format("{} poses, at least 3 are needed to register", observations.size()));
  requireTurning(cell, observations);
  if (observations.front().pose->position_only) {
    Cell start = cell;
    start.registration = registrationFromPositions(cell, observations);
    return adjust(start, observations, registrationAdjustment(robust));
  }
  std::vector<HypothesisSample> hypotheses;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    hypotheses.push_back({k, nearFar(cell, observations[k]), {observations[k].pose->T_camera_target}});
  }
  return adjustBest(cell, observations, hypotheses, 400, robust);
}

}  // namespace poecal
