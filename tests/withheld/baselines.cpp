#include "withheld/baselines.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "withheld/listed_flaws.hpp"

namespace withheld {
namespace {

struct Candidate {
  std::string place, effect;
  Eigen::MatrixXd columns;  ///< what is left of its parameters at usual size
  Eigen::MatrixXd basis;    ///< orthonormal, of the same
};

/// Slips at so many times, harmonics of seven orders, all else once.
std::vector<Candidate> candidatesOf(const Case& made, const Leftover& leftover, int times) {
  std::vector<Candidate> candidates;
  for (int time = 1; time <= times; ++time) {
    Instances instances;
    instances.slip_time = made.shots.front().stamp + time / (times + 1.0) * (made.shots.back().stamp - made.shots.front().stamp);
    for (const Flaw& flaw : listedFlaws(made.actual, made.columns, instances)) {
      if (time > 1 && !flaw.effect.ends_with("_slip")) continue;
      const Eigen::MatrixXd columns = leftover.columns(flaw);
      constexpr double kNothing = 1e-3;  // what is left at usual size, in sigma
      if (columns.norm() > kNothing) candidates.push_back({flaw.place(), flaw.effect, columns, spanOf(columns, kLeftTolerance)});
    }
  }
  return candidates;
}

double explained(const Candidate& candidate, const Eigen::VectorXd& residual) {
  return (candidate.basis.transpose() * residual).squaredNorm();
}

std::vector<std::string> smallestPValue(const std::vector<Candidate>& candidates, const Eigen::VectorXd& residual) {
  double least = std::log(0.01 / static_cast<double>(candidates.size()));
  std::vector<std::string> found;
  for (const Candidate& candidate : candidates) {
    const double p = logChiSquareTail(explained(candidate, residual), static_cast<double>(candidate.basis.cols()));
    if (p < least) {
      least = p;
      found = {candidate.place};
    }
  }
  return found;
}

std::vector<std::string> forwardByBic(std::vector<Candidate> candidates, Eigen::VectorXd residual) {
  constexpr std::size_t kMost = 4;
  const double price = std::log(static_cast<double>(residual.size()));
  std::vector<std::string> found;
  while (found.size() < kMost) {
    const Candidate* best = nullptr;
    double gain = 0.0;
    for (const Candidate& candidate : candidates) {
      const double here = explained(candidate, residual) - price * static_cast<double>(candidate.basis.cols());
      if (here > gain) {
        gain = here;
        best = &candidate;
      }
    }
    if (best == nullptr) break;
    found.push_back(best->place);
    const Eigen::MatrixXd basis = best->basis;
    residual -= basis * (basis.transpose() * residual);
    for (Candidate& candidate : candidates) {
      if (candidate.basis.cols() == 0) continue;
      const Eigen::MatrixXd rest = candidate.basis - basis * (basis.transpose() * candidate.basis);
      // Columns of what was orthonormal: lengths are shares that are left.
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rest);
      constexpr double kLeastShare = 1e-3;
      Eigen::Index rank = 0;
      while (rank < std::min(rest.rows(), rest.cols()) && std::abs(qr.matrixR()(rank, rank)) > kLeastShare) ++rank;
      candidate.basis = qr.householderQ() * Eigen::MatrixXd::Identity(rest.rows(), rank);
    }
  }
  return found;
}

/// Log of the sum of exponentials.
double logSum(const std::vector<double>& logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double value : logs) sum += std::exp(value - most);
  return most + std::log(sum);
}

/// Log odds of a candidate against nothing: parameters are normal, s times their usual size, and s is any of these.
double logEvidence(const Candidate& candidate, const Eigen::VectorXd& residual) {
  const Eigen::MatrixXd gram = candidate.columns.transpose() * candidate.columns;
  const Eigen::VectorXd right = candidate.columns.transpose() * residual;
  std::vector<double> logs;
  for (const double s : {0.1, 0.3, 1.0, 3.0, 10.0, 30.0}) {
    const Eigen::MatrixXd whole = s * s * gram + Eigen::MatrixXd::Identity(gram.rows(), gram.cols());
    const Eigen::LLT<Eigen::MatrixXd> llt(whole);
    const double log_det = 2.0 * Eigen::MatrixXd(llt.matrixL()).diagonal().array().log().sum();
    logs.push_back(0.5 * s * s * right.dot(llt.solve(right)) - 0.5 * log_det);
  }
  return logSum(logs) - std::log(static_cast<double>(logs.size()));
}

/// The most probable of all that is listed: effects are alike in probability, and so are an effect's places, and instances at a place.
std::vector<std::string> observer(const std::vector<Candidate>& candidates, const Eigen::VectorXd& residual) {
  std::map<std::string, std::map<std::string, std::vector<double>>> by_effect;
  for (const Candidate& candidate : candidates) by_effect[candidate.effect][candidate.place].push_back(logEvidence(candidate, residual));
  double best = 1.0;  // odds of e, as poecal asks for
  std::vector<std::string> found;
  for (const auto& [effect, places] : by_effect) {
    for (const auto& [place, logs] : places) {
      const auto ways = static_cast<double>(by_effect.size() * places.size() * logs.size());
      const double log_odds = logSum(logs) - std::log(ways);
      if (log_odds > best) {
        best = log_odds;
        found = {place};
      }
    }
  }
  return found;
}

std::vector<std::string> bestElasticity(const std::vector<Candidate>& candidates, const Eigen::VectorXd& residual) {
  double most = 0.0;
  std::vector<std::string> found;
  for (const Candidate& candidate : candidates) {
    if (candidate.effect == "joint_compliance" && explained(candidate, residual) > most) {
      most = explained(candidate, residual);
      found = {candidate.place};
    }
  }
  return found;
}

}  // namespace

double logChiSquareTail(double x, double freedom) {
  const double a = freedom / 2.0, z = x / 2.0;
  if (!(z > 0.0)) return 0.0;
  if (z < a + 1.0) {  // 1 - the series of the lower incomplete gamma function
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < 500; ++n) sum += term *= z / (a + n);
    return std::log1p(-std::exp(a * std::log(z) - z - std::lgamma(a)) * sum);
  }
  // Continued fraction of the upper one (Lentz; DLMF 8.9.2).
  double b = z + 1.0 - a, c = 1e300, d = 1.0 / b, fraction = d;
  for (int n = 1; n < 500; ++n) {
    const double by = -n * (n - a);
    b += 2.0;
    d = 1.0 / (by * d + b);
    c = b + by / c;
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < 1e-14) break;
  }
  return a * std::log(z) - z - std::lgamma(a) + std::log(fraction);
}

std::map<std::string, std::vector<std::string>> baselines(const Case& made) {
  if (!made.wild.empty() || made.missing > 0) return {};
  const Leftover leftover(made.actual, made.shots, made.noise, false);
  Eigen::VectorXd seen(8 * static_cast<Eigen::Index>(made.sightings.size()));
  for (std::size_t i = 0; i < made.sightings.size(); ++i) {
    seen.segment<8>(8 * static_cast<Eigen::Index>(i)) = made.sightings[i].pixels.reshaped();
  }
  const Eigen::VectorXd residual = leftover.withoutGeometry(seen - corners(made.actual, made.shots, {}));
  constexpr int kFineTimes = 39;
  const std::vector<Candidate> candidates = candidatesOf(made, leftover, 9), fine = candidatesOf(made, leftover, kFineTimes);
  return {{"observer", observer(fine, residual)},
          {"smallest p-value", smallestPValue(candidates, residual)},
          {"BIC", forwardByBic(candidates, residual)},
          {"always elasticity", bestElasticity(candidates, residual)}};
}

}  // namespace withheld
