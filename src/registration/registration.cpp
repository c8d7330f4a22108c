#include "poecal/registration/registration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "cell/transform_names.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/registration/hand_eye.hpp"
#include "poecal/registration/implausible.hpp"
#include "poecal/registration/target_pose.hpp"
#include "registration/consensus.hpp"
#include "registration/known_transforms.hpp"
#include "registration/lens_and_size.hpp"
#include "registration/plausibility.hpp"
#include "registration/target_fit.hpp"

namespace poecal {
namespace {

// Above this number robust weights have enough good pictures to lean on, and judging one by one would take long.
constexpr std::size_t kJudgedOneByOne = 60;

Consensus requireConsensus(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                           const ConsensusOptions& options) {
  std::optional<Consensus> found = findConsensus(cell, observations, samples, options);
  if (found) return std::move(*found);
  throw InsufficientData("no registration follows from these poses: the target must be seen in at least three different orientations");
}

int turningDirections(const Cell& cell, const std::vector<Observation>& observations) {
  std::vector<Eigen::Isometry3d> poses;
  for (const Observation& observation : observations) poses.push_back(nearFar(cell, observation));
  return rotationDirections(poses);
}

InsufficientData neverTurned() {
  return InsufficientData("the arm never turned the flange by more than half a degree: registration needs poses of different orientation");
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

/// One by one no more than a quarter is found, and a third that is wrong pulls the fit to itself. Where more than half of the pictures
/// agree far better without the others than what has been kept does, those others are out.
void leaveOutMinority(const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples, const Consensus& found,
                      RegistrationResult& result, std::vector<bool>& out) {
  constexpr double kAgrees = 4.0, kFarBetter = 0.25;
  const Misfit misfit = misfitIn(found.fit.cell, observations);
  std::vector<Observation> agreeing;
  std::vector<bool> others(observations.size(), false);
  for (std::size_t k = 0; k < observations.size(); ++k) {
    others[k] = !(misfit(found.fit.cell.registration, samples[k]) <= kAgrees * found.misfit + 1e-9);
    if (!others[k]) agreeing.push_back(observations[k]);
  }
  if (agreeing.size() < 6 || 2 * agreeing.size() <= observations.size() || agreeing.size() == observations.size()) return;
  const Adjustment fit = adjust(found.fit.cell, agreeing, registrationAdjustment(false));
  const auto rmsOf = [&](const Cell& cell, const std::vector<bool>& without) {
    std::vector<double> of_pictures;
    for (std::size_t k = 0; k < observations.size(); ++k) {
      if (!without[k]) of_pictures.push_back(cornerRms(cell, observations[k]));
    }
    return rms(of_pictures);
  };
  if (!(rmsOf(fit.cell, others) < kFarBetter * rmsOf(result.cell, out))) return;
  out = others;
  result.adjustment = fit;
  result.cell = fit.cell;
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

/// All turns about one axis: what slides along it is not determined, whatever rounding of the readings pretends.
void findOpenAxis(const std::vector<Observation>& observations, RegistrationResult& result) {
  std::vector<Eigen::Isometry3d> poses;
  for (const Observation& observation : observations) poses.push_back(nearFar(result.cell, observation));
  const std::optional<Eigen::Vector3d> axis = onlyAxis(poses);
  if (!axis) return;
  // A component below this is that of noise in the axis.
  constexpr double kAlong = 0.02;
  result.open_axis = axis;
  const Registration& registration = result.cell.registration;
  const Eigen::Vector3d in_camera = registration.T_camera_near.linear() * *axis;
  const Eigen::Vector3d in_far = poses.front().linear().transpose() * *axis;
  for (int k = 0; k < 3; ++k) {
    result.open_near[static_cast<std::size_t>(k)] = std::abs((*axis)(k)) > kAlong;
    if (std::abs(in_camera(k)) > kAlong) result.open.push_back(3 + k);
    if (std::abs(in_far(k)) > kAlong) result.open.push_back(9 + k);
  }
  result.warnings.push_back(
      fmt::format("all turns are about one axis: where the camera and the target are along it ({:.3f} {:.3f} {:.3f} in {}) is open",
                  axis->x(), axis->y(), axis->z(), registration.nearFrame()));
}

/// The result's samples and figures. @param plain  fitted to every picture; nothing where that is the result's cell.
void measureSamples(const std::vector<Observation>& observations, const std::vector<HypothesisSample>& hypotheses,
                    const std::vector<bool>& out, const std::optional<Cell>& plain, const ProgressFunction& progress,
                    RegistrationResult& result) {
  Progress told(progress, "pose of the flange in each picture", observations.size());
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
    told.advance();
  }
  result.rms_px = used_corners > 0.0 ? std::sqrt(used_squares / used_corners) : 0.0;
  result.rms_all_px = all_corners > 0.0 ? std::sqrt(all_squares / all_corners) : 0.0;
  result.free_rms_px = free_corners > 0.0 ? std::sqrt(free_squares / free_corners) : 0.0;
  result.corner_scale = redundancy > 0.0 ? std::sqrt(free_chi_square / redundancy) : 1.0;
  result.corner_sigma_px = result.corner_scale * statedSigma(observations);
  for (RegisteredSample& sample : result.samples) sample.covariance *= result.corner_scale * result.corner_scale;
}

}  // namespace

double keptShare(const std::vector<double>& unit_weights) { return unit_weights.empty() ? 0.0 : mean(unit_weights); }

RegistrationResult registerCell(const Cell& cell, const std::vector<Observation>& observations, const RegistrationOptions& options) {
  if (!cell.camera) throw InvalidArgument("registration from corners needs a camera");
  const std::vector<HypothesisSample> hypotheses = hypothesisSamples(cell, observations, options.progress);
  if (mirroredShare(observations) > 0.5) {
    throw ImplausibleCapture(
        "the corners of most tags run clockwise in the picture, as of a flipped (mirrored) tag, or with u and v exchanged: expected "
        "the order bottom-left, bottom-right, top-right, top-left of the upright tag seen from its front",
        InputPart::kDetections);
  }
  requireTargetFits(cell, observations, hypotheses);
  const std::size_t usable = differentPoses(hypotheses, 3);
  if (usable < 3) {
    throw InsufficientData(
        fmt::format("the target's pose is seen in {} picture{} of different poses, at least 3 are needed", usable, usable == 1 ? "" : "s"));
  }
  const bool both_known = knowsBoth(cell.registration);
  const int turning = turningDirections(cell, observations);
  if (!both_known && turning == 0) throw neverTurned();

  RegistrationResult result;
  Consensus found = both_known && turning < 2
                        ? consensusAsKnown(cell, observations, hypotheses, options.robust)
                        : requireConsensus(cell, observations, hypotheses,
                                           {.hypotheses = options.hypotheses, .robust = options.robust, .progress = options.progress});
  requirePlausible(cell, observations, hypotheses, found);
  const std::vector<std::string> contradictions = weighInKnown(cell, observations, hypotheses, options.robust, found);
  result.adjustment = found.fit;
  result.closed_form = found.closed_form;
  result.cell = result.adjustment.cell;
  std::vector<bool> out(observations.size(), false);
  std::optional<Cell> plain;
  const bool judged_one_by_one = options.leave_out_bad && !cell.arm && observations.size() <= kJudgedOneByOne;
  if (judged_one_by_one) {
    // Weights would find a few pictures that happen to agree; with every picture in, one is taken out only where the others demand it.
    result.adjustment = adjust(result.cell, observations, registrationAdjustment(false));
    result.cell = result.adjustment.cell;
    plain = result.cell;
    leaveOutBad(observations, result, out);
    leaveOutMinority(observations, hypotheses, found, result, out);
  } else {
    for (std::size_t k = 0; k < observations.size(); ++k) out[k] = keptShare(result.adjustment.weights[k]) < 0.5;
  }
  if (!cell.arm) result.warnings = checkLensAndSize(result.cell, observations, hypotheses);
  result.warnings.insert(result.warnings.end(), contradictions.begin(), contradictions.end());
  if (!both_known) findOpenAxis(observations, result);
  const Registration& known = result.cell.registration;
  for (const std::string& direction : result.adjustment.unseen) {
    // What holds it there was asked for.
    if (known.known_near && direction.find(nearName(known)) != std::string::npos) continue;
    if (known.known_far && direction.find(farName(known)) != std::string::npos) continue;
    result.warnings.push_back("the registration does not determine " + direction +
                              " (the arm's motions leave it open); it is held where it started");
  }

  measureSamples(observations, hypotheses, out, plain, options.progress, result);
  return result;
}

PoseRegistration registerPoses(const Cell& cell, const std::vector<Observation>& observations, bool robust) {
  if (observations.size() < 3) throw InsufficientData(fmt::format("{} poses, at least 3 are needed to register", observations.size()));
  // Positions alone tell of the frames by the ways between them, also where the tool keeps its orientation; where it then sits on the
  // flange stays open.
  const bool both_known = knowsBoth(cell.registration);
  const int turning = turningDirections(cell, observations);
  if (!observations.front().pose->position_only && !both_known && turning == 0) throw neverTurned();
  const std::vector<HypothesisSample> samples = hypothesisSamples(cell, observations);
  Consensus found = both_known && turning < 2 ? consensusAsKnown(cell, observations, samples, robust)
                                              : requireConsensus(cell, observations, samples, {.robust = robust});
  requirePlausible(cell, observations, samples, found);
  PoseRegistration result;
  result.warnings = weighInKnown(cell, observations, samples, robust, found);
  result.adjustment = std::move(found.fit);
  return result;
}

}  // namespace poecal
