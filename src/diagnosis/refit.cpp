#include "diagnosis/refit.hpp"

#include <algorithm>
#include <cmath>

namespace poecal {
namespace {

/// The solution of a linearisation at a given noise.
NoiseEstimate solveAt(const MeasuredCell& measured, const Linearised& linear, const NoiseEstimate& noise) {
  const ColumnPrior prior = basePrior(measured, linear.state, noise.tolerance).joinedWith(linear.column_prior);
  NoiseEstimate estimate = likelihoodsAt(linear.rows, linear.components, noise.theta, linear.columns, {prior}).front();
  estimate.tolerance = noise.tolerance;
  return estimate;
}

/// Corners that the camera's model has no pixel for: they ask for nothing any more.
std::size_t lostCorners(const CaptureRows& rows) {
  std::size_t lost = 0;
  for (const ObservationRows& part : rows.observations) {
    lost += static_cast<std::size_t>(std::count(part.rows.valid.begin(), part.rows.valid.end(), false));
  }
  return lost;
}

/// Where a fit stands, without its linearisation.
struct FitPoint {
  ModelState state;
  std::vector<Accepted> accepted;
  NoiseEstimate noise;
  double misfit = 0.0;  ///< of all rows
  std::size_t lost = 0;
};

FitPoint fitPoint(const Linearised& linear) {
  return {linear.state, linear.accepted, linear.noise, linear.misfit(), lostCorners(linear.rows)};
}

/// Whether a step led to a place that serves the rows worse, both solved at the noise that it was made with.
bool isWorse(const Linearised& here, const FitPoint& before) {
  return lostCorners(here.rows) > before.lost || here.misfit() > before.misfit;
}

/// An accepted effect's factors as parameters of the effect.
void enter(const Accepted& one, Eigen::VectorXd& parameters) {
  const Eigen::VectorXd linear = one.candidate.linearParameters(one.factors);
  for (std::size_t i = 0; i < one.candidate.linear.size(); ++i) {
    parameters(one.candidate.linear[i]) = linear(static_cast<Eigen::Index>(i));
  }
}

/// A place moved by a share of its solution, with the factors of what was accepted.
FitPoint moved(const MeasuredCell& measured, FitPoint place, double share) {
  const Eigen::VectorXd& b = place.noise.b;
  const ParameterLayout layout(place.state.cell.cell, measured.free);
  place.state.cell = place.state.cell.moved(layout, share * b.head(layout.total));
  Eigen::Index begin = layout.total;
  for (Accepted& one : place.accepted) {
    const Eigen::Index count = one.factors.size();
    one.factors += share * b.segment(begin, count);
    begin += count;
    if (one.candidate.known()) enter(one, place.state.effects[one.effect].parameters);
  }
  return place;
}

/// The largest move of a solution in standard deviations.
double largestMove(const NoiseEstimate& solution) {
  return solution.b.cwiseAbs().cwiseQuotient(solution.covariance.diagonal().cwiseMax(1e-300).cwiseSqrt()).maxCoeff();
}

/// What a solution would take off the misfit yet, were the rows linear.
double promised(const NoiseEstimate& solution) {
  const Eigen::VectorXd sigma = solution.covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  Eigen::MatrixXd scaled = sigma.cwiseInverse().asDiagonal() * solution.covariance * sigma.cwiseInverse().asDiagonal();
  scaled.diagonal().array() += 1e-9;
  const Eigen::VectorXd b = solution.b.cwiseQuotient(sigma);
  return b.dot(scaled.llt().solve(b));
}

/// The last step of a fit: verified like all others where it is more than rounding.
Linearised atRest(const MeasuredCell& measured, Linearised here, const FitPoint& place, double share,
                  const std::vector<std::size_t>& scatter, const std::vector<std::vector<std::size_t>>& groups, double settled) {
  constexpr double kAtRest = 0.5;  // of chi-square: less than chance moves it by
  FitPoint end = moved(measured, place, share);
  if (share * largestMove(place.noise) >= settled) {
    Linearised there = linearise(measured, end.state, end.accepted, scatter, groups);
    there.noise = solveAt(measured, there, place.noise);
    there.settled = promised(there.noise) < kAtRest;
    if (!isWorse(there, place)) return there;
    here.settled = promised(place.noise) < kAtRest;
    return here;
  }
  // The rows stand where they were linearised; what little moves yet is in the solution.
  here.state = std::move(end.state);
  here.accepted = std::move(end.accepted);
  return here;
}

}  // namespace

Linearised refit(const MeasuredCell& measured, ModelState state, std::vector<Accepted> accepted, const std::vector<std::size_t>& scatter,
                 const NoiseEstimate& noise, const std::vector<std::vector<std::size_t>>& groups, bool new_noise) {
  state.effects.clear();
  for (Accepted& one : accepted) {
    if (!one.candidate.known()) continue;
    one.effect = state.effects.size();
    Eigen::VectorXd parameters = one.candidate.parameters;
    enter(one, parameters);
    state.effects.push_back({*one.candidate.effect, parameters});
  }
  constexpr int kMaxSteps = 40;                  // the shortened ones too: ways through a valley take some thirty
  constexpr double kSettled = 0.01;              // standard deviations
  constexpr double kNothing = 1e-6;              // of the misfit: where that is far beyond the noise, deviations of the fit tell little
  constexpr int kNoiseSteps = 2;                 // the second sees residuals that no longer change
  constexpr double kShortest = 0.01;             // share of a step below which there is no way down
  int noises = new_noise ? kNoiseSteps - 1 : 0;  // still to be estimated anew
  Linearised here = linearise(measured, state, accepted, scatter, groups);
  if (new_noise) {
    setNoise(measured, noise, here);
  } else {
    here.noise = solveAt(measured, here, noise);
  }
  FitPoint place = fitPoint(here);
  double share = 1.0;
  const auto atEnd = [&] { return largestMove(place.noise) < kSettled || promised(place.noise) < kNothing * place.misfit; };
  for (int step = 1; step <= kMaxSteps && share >= kShortest && !atEnd(); ++step) {
    here = {};  // the bulk of the memory; the next one need not stand beside it
    const FitPoint next = moved(measured, place, share);
    here = linearise(measured, next.state, next.accepted, scatter, groups);
    here.noise = solveAt(measured, here, place.noise);
    if (isWorse(here, place)) {
      share *= 0.5;
      continue;
    }
    if (noises-- > 0) setNoise(measured, place.noise, here);
    place = fitPoint(here);
    share = 1.0;
  }
  if (share < 1.0) {  // the last step led nowhere
    here = linearise(measured, place.state, place.accepted, scatter, groups);
    here.noise = place.noise;
  }
  if (share < kShortest) {
    here.settled = promised(place.noise) < 1.0;
    return here;
  }
  return atRest(measured, std::move(here), place, share, scatter, groups, kSettled);
}

}  // namespace poecal
