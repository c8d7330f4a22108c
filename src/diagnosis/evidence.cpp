#include "diagnosis/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace poecal {
namespace {

// Answers are told apart by whole units of log-likelihood.
constexpr double kPrecision = 0.02;
constexpr double kStartScatter = 1e-4;  // [rad]

double logMeanExp(const std::vector<double>& values) {
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double value : values) sum += std::exp(value - largest);
  return largest + std::log(sum / static_cast<double>(values.size()));
}

/// The effects that change what is seen of a reference.
std::vector<AppliedEffect> seenOfReference(const ModelState& state, const std::vector<Accepted>& accepted) {
  std::vector<AppliedEffect> seen;
  for (const Accepted& one : accepted) {
    const bool lens = one.candidate.place.kind == PlaceKind::kCameraLens;
    if (one.candidate.known() && one.effect < state.effects.size() && (lens || one.candidate.moves_reference)) {
      seen.push_back(state.effects[one.effect]);
    }
  }
  return seen;
}

ColumnPrior priorOf(const std::vector<Accepted>& accepted) {
  ColumnPrior prior = ColumnPrior::none(0);
  for (const Accepted& one : accepted) prior = prior.joinedWith(ColumnPrior::independent(fittedSpread(one), one.factors));
  return prior;
}

/// Information on factors in units of the typical, in directions that are independent of each other.
struct Spectrum {
  Eigen::VectorXd values;  ///< information
  Eigen::VectorXd z;       ///< score
  Eigen::MatrixXd directions;

  Spectrum(const Eigen::MatrixXd& S, const Eigen::VectorXd& u, const Eigen::VectorXd& typical) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(typical.asDiagonal() * S * typical.asDiagonal());
    values = eigen.eigenvalues().cwiseMax(0.0);
    directions = eigen.eigenvectors();
    z = directions.transpose() * typical.cwiseProduct(u);
  }
  /// Log of the evidence where the factors are `scale` typical ones.
  double evidence(double scale) const {
    const double square = scale * scale;
    double sum = 0.0;
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      sum += 0.5 * (square * z(i) * z(i) / (1.0 + square * values(i)) - std::log1p(square * values(i)));
    }
    return sum;
  }
  /// The same where each factor has a size of its own, in units of the typical.
  double evidence(const Eigen::VectorXd& sizes) const {
    // From the directions and not from S, which rounding may have left with directions of less than no information.
    const Eigen::MatrixXd seen = sizes.asDiagonal() * (directions * values.cwiseSqrt().asDiagonal());
    Eigen::MatrixXd information = seen * seen.transpose();
    information.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> llt(information);
    return 0.5 * llt.matrixL().solve(sizes.cwiseProduct(directions * z)).squaredNorm() - llt.matrixLLT().diagonal().array().log().sum();
  }
  /// Root of each factor's expected square where they are `scale` typical ones.
  Eigen::VectorXd sizes(double scale) const {
    const Eigen::VectorXd variances = (values.array() + 1.0 / (scale * scale)).inverse();
    const Eigen::VectorXd mean = directions * variances.cwiseProduct(z);
    return (mean.array().square() + (directions.cwiseAbs2() * variances).array()).sqrt();
  }
};

/// Evidence, which is never more than half of the misfit that there is to explain: with the noise theta that remains beside an explanation,
///
///   log L1(theta) - max L0 <= log L1(theta) - log L0(theta) <= r' C(theta)^-1 r / 2.
///
/// @param theta  of the components of `linear`.
double withinMisfit(const Linearised& linear, const MeasuredCell& measured, const Eigen::VectorXd& theta, double tolerance,
                    double log_bayes) {
  const ColumnPrior prior = basePrior(measured, linear.state, tolerance).joinedWith(linear.column_prior);
  const NoiseEstimate without = likelihoodsAt(linear.rows, linear.components, theta, linear.columns, {prior}).front();
  return std::min(log_bayes, 0.5 * (without.misfit + linear.reference.misfit()));
}

std::size_t largest(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

}  // namespace

const std::vector<double>& evidenceScales() {
  static const std::vector<double> scales{0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0};
  return scales;
}

double logSumExp(const std::vector<double>& values) {
  if (values.empty()) return -std::numeric_limits<double>::infinity();
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double value : values) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

Eigen::VectorXd fittedSpread(const Accepted& one) {
  constexpr double kWide = 10.0;
  Eigen::VectorXd sigma = one.candidate.spread(one.scale, one.factors.head(one.candidate.own()).cwiseAbs());
  if (one.candidate.known()) sigma.head(static_cast<Eigen::Index>(one.candidate.linear.size())) *= kWide;
  return sigma;
}

double smallestSeen(double information) {
  constexpr double kDetectableChiSquare = 36.0;
  return information > 0.0 ? std::sqrt(kDetectableChiSquare / information) : std::numeric_limits<double>::infinity();
}

Evidence evidenceOf(const Eigen::MatrixXd& S, const Eigen::VectorXd& u, const Candidate& candidate) {
  const Eigen::VectorXd& typical = candidate.typical;
  const Spectrum all(S, u, typical);
  const Eigen::Index own = candidate.own();
  std::optional<Spectrum> own_alone;
  if (own < typical.size()) own_alone.emplace(S.topLeftCorner(own, own), u.head(own), typical.head(own));
  const Spectrum& alone = own_alone ? *own_alone : all;
  std::vector<double> over_scales;
  for (const double scale : evidenceScales()) over_scales.push_back(alone.evidence(scale));
  Evidence evidence;
  evidence.information = alone.values.sum() / static_cast<double>(own);
  evidence.clearest = alone.values.maxCoeff();
  evidence.scale = evidenceScales()[largest(over_scales)];
  if (own_alone) {
    evidence.found = alone.sizes(evidence.scale).cwiseProduct(typical.head(own));
    for (std::size_t i = 0; i < over_scales.size(); ++i) {
      over_scales[i] = all.evidence(candidate.spread(evidenceScales()[i], evidence.found).cwiseQuotient(typical));
    }
    evidence.scale = evidenceScales()[largest(over_scales)];
  }
  evidence.log_bayes = logMeanExp(over_scales);
  const double cutoff = 1e-9 * std::max(1e-30, all.values.maxCoeff());
  for (Eigen::Index i = 0; i < all.values.size(); ++i) {
    if (all.values(i) <= cutoff) continue;
    evidence.chi_square += all.z(i) * all.z(i) / all.values(i);
    ++evidence.dimension;
  }
  return evidence;
}

Eigen::MatrixXd Linearised::allColumns() const {
  Eigen::MatrixXd all(rows.size(), rows.J.cols() + columns.cols());
  all << rows.J, columns;
  return all;
}

Eigen::VectorXd Linearised::residual() const {
  return rows.r - rows.J * noise.b.head(rows.J.cols()) - columns * noise.b.tail(columns.cols());
}

Linearised linearise(const MeasuredCell& measured, const ModelState& state, const std::vector<Accepted>& accepted,
                     const std::vector<std::size_t>& scatter, const std::vector<std::vector<std::size_t>>& groups) {
  Linearised linear{.state = state,
                    .accepted = accepted,
                    .rows = captureRows(measured, state, groups),
                    .columns = {},
                    .plain_prior = {},
                    .column_prior = {},
                    .reference = {},
                    .reference_motions = {},
                    .components = {},
                    .noise = {},
                    .settled = true,
                    .jobs = measured.jobs};
  Eigen::Index width = 0;
  for (const Accepted& one : accepted) width += one.candidate.typical.size();
  linear.columns.resize(linear.rows.size(), width);
  linear.reference = ReferenceSight(measured, state.cell.cell, seenOfReference(state, accepted), linear.rows);
  if (!linear.reference.empty()) {
    linear.reference_motions = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(linear.rows.observations.size()), width);
  }
  Eigen::Index begin = 0;
  for (const Accepted& one : accepted) {
    const Eigen::MatrixXd columns = columnsOf(one.candidate, linear.rows);
    // The effect's own factors are in the state already.
    const Eigen::Index own = one.candidate.known() ? static_cast<Eigen::Index>(one.candidate.linear.size()) : 0;
    const Eigen::Index rest = columns.cols() - own;
    linear.rows.r -= columns.rightCols(rest) * one.factors.tail(rest);
    if (const Eigen::MatrixXd motions = linear.reference.motionsOf(one.candidate, linear.rows); motions.cols() > 0) {
      linear.reference_motions.middleCols(begin, columns.cols()) = motions;
      linear.reference.take(motions.rightCols(rest) * one.factors.tail(rest));
    }
    linear.columns.middleCols(begin, columns.cols()) = columns;
    begin += columns.cols();
  }
  linear.believe(priorOf(accepted));
  linear.components = noiseComponents(measured, linear.rows);
  for (const std::size_t k : scatter) linear.components.push_back(jointScatter(linear.rows, k, kStartScatter * kStartScatter));
  return linear;
}

void Linearised::believe(const ColumnPrior& prior) {
  plain_prior = column_prior = prior;
  if (reference.empty()) return;
  double log_mass = 0.0;
  column_prior =
      prior.informedBy(reference.information(reference_motions, reference_motions), reference.score(reference_motions), log_mass);
  const double determinants = 0.5 * (prior.log_determinant - column_prior.log_determinant);
  reference_misfit = reference.misfit() - 2.0 * (log_mass - determinants);
  reference_log = log_mass - 0.5 * reference.misfit();
}

void setNoise(const MeasuredCell& measured, const NoiseEstimate& from, Linearised& linear) {
  linear.noise = estimateNoise(measured, linear.state, linear.rows, linear.components, linear.columns, linear.column_prior, &from);
}

WhiteResidual whiteResidual(const Linearised& linear) {
  WhiteResidual white{Whitening(linear.rows, linear.components, linear.noise.theta), {}};
  white.e = white.whitening.apply(linear.residual());
  return white;
}

ReferenceInformation referenceInformation(const Linearised& linear, const Candidate& candidate) {
  ReferenceInformation told;
  const Eigen::MatrixXd motions = linear.reference.motionsOf(candidate, linear.rows);
  if (motions.cols() == 0) return told;
  const Eigen::Index before = linear.columns.cols(), own = motions.cols();
  told.S = Eigen::MatrixXd::Zero(before + own, before + own);
  told.S.topRightCorner(before, own) = linear.reference.information(linear.reference_motions, motions);
  told.S.bottomLeftCorner(own, before) = told.S.topRightCorner(before, own).transpose();
  told.S.bottomRightCorner(own, own) = linear.reference.information(motions, motions);
  told.u = Eigen::VectorXd::Zero(before + own);
  told.u.tail(own) = linear.reference.score(motions);
  return told;
}

ExactEvidence exactEvidence(const Linearised& linear, const MeasuredCell& measured, const Candidate& candidate, const Evidence& screened) {
  const Eigen::MatrixXd columns = columnsOf(candidate, linear.rows);
  Eigen::MatrixXd extra(linear.rows.size(), linear.columns.cols() + columns.cols());
  extra << linear.columns, columns;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(columns.cols());
  const ReferenceInformation told = referenceInformation(linear, candidate);
  const auto prior = [&](double scale, double& log_mass) {
    const ColumnPrior joined = linear.column_prior.joinedWith(ColumnPrior::independent(candidate.spread(scale, screened.found), zero));
    return told.S.size() == 0 ? joined : joined.informedBy(told.S, told.u, log_mass);
  };
  ExactEvidence exact;
  exact.scale = screened.scale;
  double log_mass = 0.0;  // of no use where the noise is estimated: it does not hang on that
  const ColumnPrior at_screened = prior(screened.scale, log_mass);
  exact.noise = estimateNoise(measured, linear.state, linear.rows, linear.components, extra, at_screened, &linear.noise, kPrecision);
  const ColumnPrior base = basePrior(measured, linear.state, exact.noise.tolerance);
  std::vector<ColumnPrior> priors{base.joinedWith(at_screened)};
  std::vector<double> masses(evidenceScales().size(), 0.0);
  for (std::size_t i = 0; i < masses.size(); ++i) priors.push_back(base.joinedWith(prior(evidenceScales()[i], masses[i])));
  const std::vector<NoiseEstimate> estimates = likelihoodsAt(linear.rows, linear.components, exact.noise.theta, extra, priors);
  const double penalty = estimates.front().log_likelihood - exact.noise.log_likelihood;
  std::vector<double> over_scales;
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < evidenceScales().size(); ++i) {
    const NoiseEstimate& here = estimates[i + 1];
    const double likelihood = here.log_likelihood + masses[i];
    over_scales.push_back(likelihood - penalty - linear.noise.log_likelihood);
    if (likelihood > best) {
      best = likelihood;
      exact.scale = evidenceScales()[i];
      exact.noise.b = here.b;
      exact.noise.covariance = here.covariance;
    }
  }
  exact.log_bayes = withinMisfit(linear, measured, exact.noise.theta, exact.noise.tolerance, logMeanExp(over_scales));
  return exact;
}

ExactEvidence scatterEvidence(const Linearised& linear, const MeasuredCell& measured, std::size_t k) {
  std::vector<NoiseComponent> components = linear.components;
  components.push_back(jointScatter(linear.rows, k, kStartScatter * kStartScatter));
  ExactEvidence exact;
  exact.noise =
      estimateNoise(measured, linear.state, linear.rows, components, linear.columns, linear.column_prior, &linear.noise, kPrecision);
  // One variance more: what was a factor of e^3 either way is known to a few tens of percent.
  constexpr double kOccam = 1.5;
  // Joints come back to some thousandths of a radian at worst: what moves farther at random is believed less and less.
  constexpr double kUsual = 1e-3, kSpread = 0.7;
  const double slides = measured.start.arm->joints[k].type == JointType::kPrismatic ? kMetresPerRadian : 1.0;
  const double sigma = std::sqrt(exact.noise.theta(exact.noise.theta.size() - 1));
  const double above = std::max(0.0, std::log(sigma / (slides * kUsual)) / kSpread);
  const double log_bayes = exact.noise.log_likelihood - linear.noise.log_likelihood - kOccam - 0.5 * above * above;
  const Eigen::VectorXd others = exact.noise.theta.head(exact.noise.theta.size() - 1);
  exact.log_bayes = withinMisfit(linear, measured, others, exact.noise.tolerance, log_bayes);
  exact.scale = sigma;
  return exact;
}

}  // namespace poecal
