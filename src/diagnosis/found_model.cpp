#include "diagnosis/found_model.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "identification/fit.hpp"

namespace poecal {
namespace {

/// An effect with what was estimated of it: the deviations of its linear parameters, one after the other.
AppliedEffect withDeviations(AppliedEffect applied, const Eigen::VectorXd& deviations) {
  applied.standard_deviation = Eigen::VectorXd::Constant(applied.parameters.size(), std::numeric_limits<double>::quiet_NaN());
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < applied.effect.parameters().size(); ++i) {
    if (applied.effect.parameters()[i].role != ParameterRole::kLinear) continue;
    applied.standard_deviation(static_cast<Eigen::Index>(i)) = deviations(next++);
  }
  return applied;
}

/// What no listed effect explains, as the model holds it.
AppliedEffect curveOf(const Accepted& one, const Cell& cell) {
  const Candidate& candidate = one.candidate;
  if (!candidate.curve->terms.empty()) return makeAngleWaves(candidate.place.index, candidate.curve->terms, one.factors, cell);
  const Curve& curve = *candidate.curve;
  if (!curve.cycles.empty()) return makeSway(curve.place, candidate.driver, curve.range, curve.cycles, one.factors, cell);
  return makeCurve(curve.place, candidate.driver, curve.range, one.factors, cell);
}

/// What was found as the model holds it: named effects and what their stated masses leave out, curves, and joints that move at random.
std::vector<AppliedEffect> appliedEffects(const Selection& selection, const std::vector<Eigen::VectorXd>& deviations) {
  const ModelState& state = selection.linear.state;
  std::vector<AppliedEffect> effects;
  for (std::size_t k = 0; k < selection.linear.accepted.size(); ++k) {
    const Accepted& one = selection.linear.accepted[k];
    const Candidate& candidate = one.candidate;
    effects.push_back(withDeviations(candidate.known() ? state.effects[one.effect] : curveOf(one, state.cell.cell), deviations[k]));
    if (!candidate.mass_errors) continue;
    const Eigen::Index count = candidate.mass_errors->start().size();
    effects.push_back(withDeviations({*candidate.mass_errors, one.factors.tail(count)}, deviations[k].tail(count)));
  }
  for (const FoundEffect& found : selection.findings) {
    if (!found.scatter) continue;
    effects.push_back(
        makeEffect({.effect = found.name, .location = found.place.name(), .parameters = {{"sigma", scatterSigma(selection, found)}}},
                   state.cell.cell));
  }
  return effects;
}

}  // namespace

std::vector<Eigen::VectorXd> parameterDeviations(const Selection& selection) {
  std::vector<Eigen::VectorXd> all;
  Eigen::Index begin = selection.linear.rows.J.cols();
  for (const Accepted& one : selection.linear.accepted) {
    const Eigen::Index count = one.factors.size();
    const Eigen::MatrixXd& T = one.candidate.to_parameters;
    const Eigen::MatrixXd covariance = selection.linear.noise.covariance.block(begin, begin, count, count);
    const Eigen::VectorXd variance = T.size() > 0 ? Eigen::VectorXd((T * covariance * T.transpose()).diagonal()) : covariance.diagonal();
    all.push_back(variance.cwiseMax(0.0).cwiseSqrt());
    begin += count;
  }
  return all;
}

Eigen::MatrixXd factorCovariance(const Selection& selection, std::size_t finding) {
  Eigen::Index begin = selection.linear.rows.J.cols();
  for (std::size_t i = 0; i < finding; ++i) {
    if (selection.findings[i].accepted) begin += selection.findings[i].accepted->factors.size();
  }
  const Eigen::Index count = selection.findings[finding].accepted->factors.size();
  return selection.linear.noise.covariance.block(begin, begin, count, count);
}

double factorsChiSquare(const Selection& selection, std::size_t finding) {
  const Accepted& one = *selection.findings[finding].accepted;
  const Eigen::Index count = one.factors.size();
  const Eigen::MatrixXd covariance = factorCovariance(selection, finding);
  const Eigen::VectorXd d = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> correlation(d.asDiagonal() * covariance * d.asDiagonal());
  const Eigen::VectorXd along = correlation.eigenvectors().transpose() * d.cwiseProduct(one.factors);
  // Factors that move together all but exactly: of what is between them, rounding is left.
  constexpr double kRounding = 1e-9;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double variance = correlation.eigenvalues()(i);
    if (variance > kRounding) sum += along(i) * along(i) / variance;
  }
  return sum;
}

double scatterSigma(const Selection& selection, const FoundEffect& found) {
  return std::sqrt(*varianceOf(scatterName(*found.scatter), selection.linear.components, selection.linear.noise));
}

void tellModel(const Selection& selection, const Identification& identification, Diagnosis& diagnosis) {
  diagnosis.model = identification.model;
  const ModelState& state = selection.linear.state;
  diagnosis.model.cell = state.cell.cell;
  if (!selection.measured.target.points.empty()) diagnosis.model.target = selection.measured.target;
  diagnosis.model.effects = appliedEffects(selection, parameterDeviations(selection));
  const MeasuredCell& measured = selection.measured;
  diagnosis.model.driver_ranges = driverRangesOf(diagnosis.model.effects, measured.samples);
  // Row numbers stand in for times; no other table shares them.
  if (!measured.timed) diagnosis.model.driver_ranges.erase("stamp");
  const ParameterLayout layout(state.cell.cell, measured.free);
  const Eigen::MatrixXd& covariance = selection.linear.noise.covariance;
  const auto deviation = [&covariance](int begin) { return Vector6d(covariance.diagonal().segment<6>(begin).cwiseMax(0.0).cwiseSqrt()); };
  ModelDeviation& deviations_of = diagnosis.model.deviation;
  deviations_of.twists =
      twistDeviations(*measured.start.arm, state.cell.beta, *state.cell.cell.arm, covariance.topLeftCorner(layout.twists, layout.twists));
  if (layout.gamma >= 0) deviations_of.gamma = deviation(layout.gamma);
  if (layout.near >= 0) deviations_of.T_camera_near = deviation(layout.near);
  if (layout.far >= 0) deviations_of.T_far_target = deviation(layout.far);
  const Arm& before = *selection.base.cell.cell.arm;
  const Arm& after = *state.cell.cell.arm;
  for (std::size_t k = 0; k < after.joints.size(); ++k) {
    const AxisOffset offset = axisOffset(before.joints[k], after.joints[k]);
    diagnosis.axis_moves.push_back({after.joints[k].name, offset.tilt, offset.shift});
  }
}

}  // namespace poecal
