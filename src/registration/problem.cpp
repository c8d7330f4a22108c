#include "registration/problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "poecal/core/error.hpp"
#include "poecal/core/random.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr std::size_t kCorners = 12;
constexpr int kHypotheses = 120;
constexpr int kPairings = 5;
// What loose arms have, 1 sigma.
constexpr double kLooseRotation = 6e-3;
constexpr double kLoosePosition = 2e-3;

/// Corners that are far from each other: each the one farthest from those chosen before.
std::vector<CornerMeasurement> spreadCorners(const std::vector<CornerMeasurement>& corners) {
  if (corners.size() <= kCorners) return corners;
  std::vector<double> distance(corners.size(), std::numeric_limits<double>::infinity());
  std::vector<CornerMeasurement> chosen{corners.front()};
  while (chosen.size() < kCorners) {
    std::size_t farthest = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      distance[k] = std::min(distance[k], (corners[k].p_target - chosen.back().p_target).norm());
      if (distance[k] > distance[farthest]) farthest = k;
    }
    chosen.push_back(corners[farthest]);
  }
  return chosen;
}

std::size_t cornerCount(const Problem& problem) {
  return std::accumulate(problem.observations.begin(), problem.observations.end(), std::size_t{0},
                         [](std::size_t sum, const Observation& observation) { return sum + observation.corners.size(); });
}

/// The rows [from, to).
Problem rowsOf(const Problem& problem, std::size_t from, std::size_t to) {
  Problem some;
  some.cell = problem.cell;
  for (std::size_t k = from; k < to; ++k) some.add(problem.observations[problem.samples[k].observation], problem.samples[k]);
  return some;
}

bool usable(const Problem& problem) { return problem.observations.size() >= 3; }

}  // namespace

void Problem::add(Observation observation, HypothesisSample sample) {
  sample.observation = observations.size();
  observations.push_back(std::move(observation));
  samples.push_back(std::move(sample));
}

Problem thinned(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                std::size_t rows) {
  std::vector<std::size_t> different;
  const std::size_t looked_at = std::max<std::size_t>(1, observations.size() / (4 * rows));
  for (std::size_t k = 0; k < observations.size(); k += looked_at) {
    const bool position = observations[k].pose && observations[k].pose->position_only;
    if (samples[k].candidates.empty() && !position) continue;
    const bool known = std::any_of(different.begin(), different.end(),
                                   [&](std::size_t earlier) { return samePose(samples[earlier].T_near_far, samples[k].T_near_far); });
    if (!known) different.push_back(k);
  }
  Problem problem;
  problem.cell = cell;
  const std::size_t count = std::min(rows, different.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = different[i * different.size() / count];
    Observation observation = observations[k];
    observation.corners = spreadCorners(observation.corners);
    problem.add(std::move(observation), samples[k]);
  }
  return problem;
}

Problem evenly(const Cell& cell, const std::vector<Observation>& observations, std::size_t rows) {
  Problem few;
  few.cell = cell;
  rows = std::min(rows, observations.size());
  for (std::size_t i = 0; i < rows; ++i) few.observations.push_back(observations[i * observations.size() / rows]);
  return few;
}

std::map<PointId, Eigen::Vector3d> pointsSeen(const std::vector<Observation>& observations) {
  std::map<PointId, Eigen::Vector3d> points;
  for (const Observation& observation : observations) {
    for (const CornerMeasurement& corner : observation.corners) points[corner.id] = corner.p_target;
  }
  return points;
}

std::vector<double> distinctPlaces(std::vector<double> values) {
  constexpr double kSame = 1e-6;  // [m]
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end(), [](double a, double b) { return std::abs(a - b) < kSame; }), values.end());
  return values;
}

bool keepsMost(const Problem& altered, const Problem& whole) {
  return altered.observations.size() >= std::max<std::size_t>(4, whole.observations.size() * 3 / 4) &&
         4 * cornerCount(altered) >= 3 * cornerCount(whole);
}

void renewPoses(Problem& problem) {
  for (HypothesisSample& sample : problem.samples) sample.T_near_far = nearFar(problem.cell, problem.observations[sample.observation]);
}

void renewPictures(Problem& problem) { problem.samples = hypothesisSamples(problem.cell, problem.observations); }

void scaleTarget(Problem& problem, double factor) {
  for (Observation& observation : problem.observations) {
    for (CornerMeasurement& corner : observation.corners) corner.p_target *= factor;
    if (observation.pose) observation.pose->T_camera_target.translation() *= factor;
  }
  for (HypothesisSample& sample : problem.samples) {
    for (Eigen::Isometry3d& candidate : sample.candidates) candidate.translation() *= factor;
  }
}

Problem agreeing(const Problem& problem, const Registration& registration) {
  const Misfit misfit = misfitIn(problem.cell, problem.observations);
  const double limit = 4.0 * medianMisfit(registration, problem.samples, misfit) + 1e-9;
  Problem kept;
  kept.cell = problem.cell;
  for (const HypothesisSample& sample : problem.samples) {
    if (!(misfit(registration, sample) <= limit)) continue;
    kept.add(problem.observations[sample.observation], sample);
  }
  return kept;
}

std::optional<Consensus> solve(const Problem& problem, std::size_t refined) {
  if (!usable(problem)) return std::nullopt;
  try {
    return findConsensus(problem.cell, problem.observations, problem.samples, {.hypotheses = kHypotheses, .refined = refined});
  } catch (const InsufficientData&) {
    return std::nullopt;  // an altered capture may leave too little
  }
}

std::vector<Consensus> registeredEnds(const Problem& problem, std::size_t part) {
  std::vector<Consensus> ends;
  if (part < kFewestRows) return ends;
  for (const std::size_t from : {std::size_t{0}, problem.samples.size() - part}) {
    if (std::optional<Consensus> found = solve(rowsOf(problem, from, from + part), 2)) ends.push_back(std::move(*found));
  }
  return ends;
}

double quickMisfit(const Problem& problem) {
  if (!usable(problem)) return std::numeric_limits<double>::infinity();
  const auto found = searchHypotheses(problem.cell, problem.observations, problem.samples, kHypotheses);
  return found.empty() ? std::numeric_limits<double>::infinity() : found.front().score;
}

Calibrated calibrate(const Problem& problem, const Registration& start) {
  Cell cell = problem.cell;
  cell.registration = start;
  AdjustmentOptions options = registrationAdjustment(true);
  Calibrated result;
  if (cell.arm) {
    options.free.twists = true;
    options.twists = TwistPrior(*cell.arm, kLoosePosition, kLooseRotation);
    options.max_iterations = 30;
    Adjustment adjustment = adjust(cell, problem.observations, options);
    cell = std::move(adjustment.cell);
    const Eigen::VectorXd& beta = adjustment.beta;
    result.deviation = std::sqrt(beta.dot(options.twists.precision * beta) / static_cast<double>(beta.size()));
  }
  Problem calibrated = problem;
  calibrated.cell = cell;
  renewPoses(calibrated);
  result.misfit = medianMisfit(cell.registration, calibrated.samples, misfitIn(calibrated.cell, calibrated.observations));
  return result;
}

double chanceMisfit(const Problem& problem) {
  std::vector<double> misfits;
  Rng rng(20130157);
  Problem shuffled = problem;
  for (int pairing = 0; pairing < kPairings; ++pairing) {
    for (std::size_t k = shuffled.samples.size(); k > 1; --k) {
      const std::size_t other = rng.below(k);
      std::swap(shuffled.samples[k - 1].T_near_far, shuffled.samples[other].T_near_far);
      std::swap(shuffled.observations[k - 1].q, shuffled.observations[other].q);
      std::swap(shuffled.observations[k - 1].T_base_flange, shuffled.observations[other].T_base_flange);
    }
    if (const auto found = solve(shuffled, 1)) misfits.push_back(found->misfit);
  }
  return misfits.empty() ? 0.0 : median(misfits);
}

double freeMisfit(const std::vector<HypothesisSample>& samples) {
  std::vector<double> misfits;
  for (const HypothesisSample& sample : samples) {
    if (!sample.candidates.empty()) misfits.push_back(sample.free_misfit);
  }
  return misfits.empty() ? 0.0 : median(misfits);
}

}  // namespace poecal
