#include <cmath>

#include "diagnosis/selection.hpp"

namespace poecal {
namespace {

/// The solution of a linearisation at a given noise.
NoiseEstimate solveAt(const MeasuredCell& measured, const Linearised& linear, const NoiseEstimate& noise) {
  const Eigen::MatrixXd X = linear.allColumns();
  const ColumnPrior prior = basePrior(measured, linear.state, noise.tolerance).joinedWith(linear.column_prior);
  NoiseEstimate estimate = likelihoodAt(linear.rows, linear.components, noise.theta, X, prior);
  estimate.tolerance = noise.tolerance;
  return estimate;
}

/// Moves the state and the accepted factors by a solution. @return the largest move in standard deviations.
double take(const MeasuredCell& measured, const NoiseEstimate& solution, ModelState& state, std::vector<Accepted>& accepted) {
  const ParameterLayout layout(state.cell.cell, measured.free);
  state.cell = state.cell.moved(layout, solution.b.head(layout.total));
  Eigen::Index begin = layout.total;
  for (Accepted& one : accepted) {
    const Eigen::Index count = one.factors.size();
    one.factors += solution.b.segment(begin, count);
    begin += count;
    if (!one.candidate.known()) continue;
    Eigen::VectorXd& parameters = state.effects[one.effect].parameters;
    for (std::size_t i = 0; i < one.candidate.linear.size(); ++i)
      parameters(one.candidate.linear[i]) = one.factors(static_cast<Eigen::Index>(i));
  }
  return solution.b.cwiseAbs().cwiseQuotient(solution.covariance.diagonal().cwiseMax(1e-300).cwiseSqrt()).maxCoeff();
}

}  // namespace

Linearised refit(const MeasuredCell& measured, ModelState state, std::vector<Accepted> accepted, const std::vector<std::size_t>& scatter,
                 const NoiseEstimate& noise, const std::vector<std::vector<std::size_t>>& groups, bool new_noise) {
  state.effects.clear();
  for (Accepted& one : accepted) {
    if (!one.candidate.known()) continue;
    one.effect = state.effects.size();
    Eigen::VectorXd parameters = one.candidate.parameters;
    for (std::size_t i = 0; i < one.candidate.linear.size(); ++i)
      parameters(one.candidate.linear[i]) = one.factors(static_cast<Eigen::Index>(i));
    state.effects.push_back({*one.candidate.effect, parameters});
  }
  constexpr int kMaxSteps = 8;
  constexpr double kSettled = 0.01;  // standard deviations
  constexpr int kNoiseSteps = 2;     // the second sees residuals that no longer change
  NoiseEstimate at = noise;
  for (int step = 0;; ++step) {
    Linearised linear = linearise(measured, state, accepted, scatter, groups);
    if (new_noise && step < kNoiseSteps) {
      setNoise(measured, &at, linear);
    } else {
      linear.noise = solveAt(measured, linear, at);
    }
    at = linear.noise;
    const double moved = take(measured, linear.noise, state, accepted);
    if (moved < kSettled || step == kMaxSteps) {
      // The rows stand where they were linearised; what little moved since is in the solution.
      linear.state = state;
      linear.accepted = accepted;
      return linear;
    }
  }
}

}  // namespace poecal
