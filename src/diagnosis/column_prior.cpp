#include "diagnosis/column_prior.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace poecal {

ColumnPrior ColumnPrior::none(Eigen::Index columns) {
  return {Eigen::VectorXd::Zero(columns), Eigen::MatrixXd::Zero(columns, columns), 0.0};
}

ColumnPrior ColumnPrior::independent(const Eigen::VectorXd& sigma, const Eigen::VectorXd& offset) {
  ColumnPrior prior{offset, sigma.array().square().inverse().matrix().asDiagonal(), 0.0};
  prior.log_determinant = -2.0 * sigma.array().log().sum();
  return prior;
}

ColumnPrior ColumnPrior::joinedWith(const ColumnPrior& other) const {
  ColumnPrior both = none(offset.size() + other.offset.size());
  both.offset << offset, other.offset;
  both.precision.topLeftCorner(offset.size(), offset.size()) = precision;
  both.precision.bottomRightCorner(other.offset.size(), other.offset.size()) = other.precision;
  both.log_determinant = log_determinant + other.log_determinant;
  return both;
}

ColumnPrior ColumnPrior::informedBy(const Eigen::MatrixXd& S, const Eigen::VectorXd& u, double& log_mass) const {
  ColumnPrior informed{offset, precision + S, 0.0};
  const Eigen::LLT<Eigen::MatrixXd> llt(informed.precision);
  const Eigen::VectorXd pull = u - precision * offset;
  informed.offset = -llt.solve(pull);
  informed.log_determinant = 2.0 * llt.matrixLLT().diagonal().array().log().sum();
  log_mass = 0.5 * (-pull.dot(informed.offset) - offset.dot(precision * offset) + log_determinant - informed.log_determinant);
  return informed;
}

ColumnPrior basePrior(const MeasuredCell& measured, const ModelState& state, double tolerance) {
  const ParameterLayout layout(state.cell.cell, measured.free);
  AdjustmentOptions options;
  options.far_position = kFarPosition;
  options.camera_prior_sigma = measured.camera_sigma;
  const Eigen::ArrayXd sigma = priorSigma(layout, options, measured.start).array();
  ColumnPrior prior{priorDeviation(state.cell, layout, measured.start), sigma.square().inverse().matrix().asDiagonal(), 0.0};
  prior.log_determinant = -2.0 * sigma.isFinite().select(sigma, 1.0).log().sum();
  const Eigen::Index twists = measured.twists.precision.rows();
  prior.precision.topLeftCorner(twists, twists) = measured.twists.precision / (tolerance * tolerance);
  prior.log_determinant += measured.twists.log_determinant - 2.0 * static_cast<double>(twists) * std::log(tolerance);
  return prior;
}

}  // namespace poecal
