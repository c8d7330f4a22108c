#include "registration/consensus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

#include "poecal/core/random.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/registration/target_pose.hpp"

namespace poecal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// y_i = R (R_i p + t_i) + t for positions alone: by turns R, t for a known tool point p (orthogonal Procrustes) and p, t for a known R
/// (linear).
Registration registrationFromPositions(const Cell& cell, const std::vector<Observation>& observations,
                                       const std::vector<HypothesisSample>& samples) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd measured(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    measured.col(k) = observations[samples[static_cast<std::size_t>(k)].observation].pose->T_camera_target.translation();
  }
  // Converges geometrically, by about the square of (tool length / spread of the poses) a round.
  for (int round = 0; round < 100; ++round) {
    Eigen::Matrix3Xd modelled(3, count);
    for (Eigen::Index k = 0; k < count; ++k) modelled.col(k) = samples[static_cast<std::size_t>(k)].T_near_far * p;
    const Eigen::Matrix3Xd a = modelled.colwise() - modelled.rowwise().mean();
    const Eigen::Matrix3Xd b = measured.colwise() - measured.rowwise().mean();
    R = nearestRotation(b * a.transpose());
    Eigen::MatrixXd A(3 * count, 6);
    Eigen::VectorXd rhs(3 * count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Isometry3d& pose = samples[static_cast<std::size_t>(k)].T_near_far;
      A.block<3, 3>(3 * k, 0) = R * pose.linear();
      A.block<3, 3>(3 * k, 3).setIdentity();
      rhs.segment<3>(3 * k) = measured.col(k) - R * pose.translation();
    }
    const Eigen::VectorXd x = A.completeOrthogonalDecomposition().solve(rhs);
    const bool settled = (x.head<3>() - p).norm() + (x.tail<3>() - t).norm() < 1e-12;
    p = x.head<3>();
    t = x.tail<3>();
    if (settled) break;
  }
  Registration registration = cell.registration;
  registration.T_camera_near.linear() = R;
  registration.T_camera_near.translation() = t;
  registration.T_far_target = Eigen::Translation3d(p) * Eigen::Isometry3d::Identity();
  return registration;
}

/// Positions have no minimal set in closed form: random sets of six, and all of them.
std::vector<Hypothesis> searchByPositions(const Cell& cell, const std::vector<Observation>& observations,
                                          const std::vector<HypothesisSample>& samples, const Misfit& misfit, int hypotheses) {
  constexpr std::size_t kSet = 6;
  // Each takes as long as some ten closed forms do.
  const int trials = hypotheses / 10;
  std::vector<Hypothesis> found;
  const auto add = [&](const std::vector<HypothesisSample>& some) {
    const Registration registration = registrationFromPositions(cell, observations, some);
    found.push_back({registration, medianMisfit(registration, samples, misfit)});
  };
  add(samples);
  Rng rng(20130156);
  std::vector<HypothesisSample> shuffled = samples;
  for (int trial = 0; trial < trials && samples.size() > kSet; ++trial) {
    for (std::size_t k = 0; k < kSet; ++k) std::swap(shuffled[k], shuffled[k + rng.below(shuffled.size() - k)]);
    add({shuffled.begin(), shuffled.begin() + kSet});
  }
  std::stable_sort(found.begin(), found.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
  return found;
}

bool positionsOnly(const std::vector<Observation>& observations) {
  return !observations.empty() && observations.front().pose && observations.front().pose->position_only;
}

}  // namespace

Eigen::Isometry3d nearFar(const Cell& cell, const Observation& observation) {
  const Eigen::Isometry3d T_base_flange = modelFlange(cell, observation);
  return cell.registration.setup == Setup::kEyeToHand ? T_base_flange : T_base_flange.inverse();
}

double cornerRms(const Cell& cell, std::span<const Observation> observations) {
  double sum = 0.0;
  int units = 0;
  for (const Observation& observation : observations) {
    for (const UnitResidual& unit : residuals(cell, observation)) sum += unit.residual.squaredNorm();
    units += observation.unitCount();
  }
  const double rms = std::sqrt(sum / std::max(1, units));
  return std::isnan(rms) ? kInfinity : rms;
}

std::vector<HypothesisSample> hypothesisSamples(const Cell& cell, const std::vector<Observation>& observations,
                                                const ProgressFunction& progress) {
  std::vector<HypothesisSample> samples;
  Progress told(progress, "pose of the target in each picture", observations.size());
  for (std::size_t k = 0; k < observations.size(); ++k) {
    HypothesisSample sample;
    sample.observation = k;
    sample.T_near_far = nearFar(cell, observations[k]);
    if (!observations[k].pose) {
      for (const TargetPose& pose : targetPoses(*cell.camera, observations[k])) {
        if (sample.candidates.empty()) sample.free_misfit = pose.rms_px;
        sample.candidates.push_back(pose.T_camera_target);
      }
    } else if (!observations[k].pose->position_only) {
      sample.candidates.push_back(observations[k].pose->T_camera_target);
    }
    samples.push_back(std::move(sample));
    told.advance();
  }
  return samples;
}

Misfit misfitIn(const Cell& cell, const std::vector<Observation>& observations) {
  // The search asks this hundreds of times of each sample, so it does not go through the arm again.
  return [&cell, &observations](const Registration& registration, const HypothesisSample& sample) {
    const Observation& observation = observations[sample.observation];
    const Eigen::Isometry3d T_camera_target = registration.T_camera_near * sample.T_near_far * registration.T_far_target;
    if (observation.pose) {
      const Vector6d e = observation.pose->whitening * poseDifference(observation.pose->T_camera_target, T_camera_target);
      return std::isfinite(e.norm()) ? e.norm() : kInfinity;
    }
    double sum = 0.0;
    for (const CornerMeasurement& corner : observation.corners) {
      const std::optional<Eigen::Vector2d> px = project(*cell.camera, T_camera_target * corner.p_target);
      if (!px) return kInfinity;
      sum += (corner.px - *px).squaredNorm();
    }
    const double rms = std::sqrt(sum / std::max(1, observation.unitCount()));
    return std::isfinite(rms) ? rms : kInfinity;
  };
}

AdjustmentOptions registrationAdjustment(bool robust) {
  AdjustmentOptions options;
  options.free.near = true;
  options.free.far = true;
  options.robust = robust;
  return options;
}

double medianMisfit(const Registration& registration, const std::vector<HypothesisSample>& samples, const Misfit& misfit) {
  std::vector<double> misfits;
  for (const HypothesisSample& sample : samples) misfits.push_back(misfit(registration, sample));
  const auto middle = misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2);
  std::nth_element(misfits.begin(), middle, misfits.end());
  return *middle;
}

std::vector<Hypothesis> searchHypotheses(const Cell& cell, const std::vector<Observation>& observations,
                                         const std::vector<HypothesisSample>& samples, int hypotheses) {
  const Misfit misfit = misfitIn(cell, observations);
  if (positionsOnly(observations)) return searchByPositions(cell, observations, samples, misfit, hypotheses);
  return searchRegistrations(cell.registration.setup, samples, misfit, hypotheses);
}

std::optional<Consensus> findConsensus(const Cell& cell, const std::vector<Observation>& observations,
                                       const std::vector<HypothesisSample>& samples, const ConsensusOptions& options) {
  const Misfit misfit = misfitIn(cell, observations);
  Progress searching(options.progress, "searching where camera and target are", 1);
  searching.show();
  std::vector<Hypothesis> found = searchHypotheses(cell, observations, samples, options.hypotheses);
  if (found.empty()) return std::nullopt;
  searching.advance();
  if (found.size() > options.refined) found.resize(options.refined);
  // Which is best shows on some of the samples; only that one is refined on all of them.
  constexpr std::size_t kCompared = 300;
  const std::size_t stride = (observations.size() + kCompared - 1) / kCompared;
  std::vector<Observation> some;
  std::vector<HypothesisSample> compared;
  for (std::size_t k = 0; k < observations.size(); k += stride) {
    some.push_back(observations[k]);
    compared.push_back(samples[k]);
  }
  Progress progress(options.progress, "registering", found.size() + (stride > 1 ? 1 : 0));
  progress.show();
  std::optional<Consensus> best;
  for (const Hypothesis& hypothesis : found) {
    Cell start = cell;
    start.registration = hypothesis.registration;
    Adjustment fit = adjust(start, some, registrationAdjustment(options.robust));
    const double of_most = medianMisfit(fit.cell.registration, compared, misfit);
    if (!best || of_most < best->misfit * (1.0 - 1e-9)) best = Consensus{std::move(fit), hypothesis.registration, of_most};
    progress.advance();
  }
  if (stride > 1) {
    best->fit = adjust(best->fit.cell, observations, registrationAdjustment(options.robust));
    best->misfit = medianMisfit(best->fit.cell.registration, samples, misfit);
    progress.advance();
  }
  return best;
}

}  // namespace poecal
