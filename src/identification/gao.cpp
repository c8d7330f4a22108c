#include "identification/gao.hpp"

#include <cmath>

#include <Eigen/QR>

#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

struct StackedRows {
  Eigen::MatrixXd L;
  Eigen::VectorXd Y;
};

StackedRows stack(const Arm& arm, const std::vector<Eigen::VectorXd>& q, const std::vector<Eigen::Isometry3d>& T_base_flange, double length_unit) {
  const int twists = twistParameterCount(arm);
  const auto poses = static_cast<Eigen::Index>(q.size());
  StackedRows rows{Eigen::MatrixXd(6 * poses, twists + 6), Eigen::VectorXd(6 * poses)};
  const Eigen::VectorXd at_zero = Eigen::VectorXd::Zero(twists);
  const Matrix6d K_st = leftJacobianSe3(arm.gamma);
  for (Eigen::Index k = 0; k < poses; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const ArmChain chain = forwardChain(arm, q[i]);
    rows.Y.segment<6>(6 * k) = logSe3(T_base_flange[i] * chain.T_base_flange.inverse());
    rows.L.block(6 * k, 0, 6, twists) = twistJacobian(arm, at_zero, arm, chain, q[i]);
    rows.L.block<6, 6>(6 * k, twists) = adjoint(chain.P.back()) * K_st;
    rows.Y.segment<3>(6 * k + 3) /= length_unit;
    rows.L.middleRows<3>(6 * k + 3) /= length_unit;
  }
  return rows;
}

double rmsOfRows(const StackedRows& rows) { return std::sqrt(rows.Y.squaredNorm() / static_cast<double>(rows.Y.size())); }

}  // namespace

GaoResult gao(const Arm& nominal, const std::vector<Eigen::VectorXd>& q, const std::vector<Eigen::Isometry3d>& T_base_flange, const GaoOptions& options) {
  GaoResult result;
  result.arm = nominal;
  StackedRows rows = stack(nominal, q, T_base_flange, options.length_unit);
  result.residuals.push_back(rmsOfRows(rows));
  const int twists = twistParameterCount(nominal);
  Eigen::VectorXd scale;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr(rows.L.rows(), rows.L.cols());
  for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
    scale = rows.L.colwise().norm().transpose().unaryExpr([](double n) { return n > 0.0 ? 1.0 / n : 1.0; });
    qr.setThreshold(1e-10);
    qr.compute(rows.L * scale.asDiagonal());
    if (iteration == options.max_iterations) break;
    const Eigen::VectorXd x = scale.cwiseProduct(qr.solve(rows.Y));
    Arm next = displaceTwists(result.arm, x.head(twists));
    next.gamma += x.tail<6>();
    StackedRows next_rows = stack(next, q, T_base_flange, options.length_unit);
    const double rms = rmsOfRows(next_rows);
    // Rounding, or the noise floor: further steps only stir the last digits.
    if (!(rms < result.residuals.back() * (1.0 - 1e-9))) {
      result.converged = true;
      break;
    }
    result.residuals.push_back(rms);
    result.arm = std::move(next);
    rows = std::move(next_rows);
  }
  result.rank = static_cast<int>(qr.rank());
  const auto R = qr.matrixT().diagonal().head(result.rank).cwiseAbs();
  result.condition_number = R.maxCoeff() / R.minCoeff();
  const Eigen::MatrixXd pseudo_inverse = scale.asDiagonal() * qr.pseudoInverse();
  result.covariance = Eigen::MatrixXd::Zero(rows.L.cols(), rows.L.cols());
  for (Eigen::Index k = 0; k < rows.Y.size(); k += 6) {
    const Eigen::VectorXd influence = pseudo_inverse.middleCols<6>(k) * rows.Y.segment<6>(k);
    result.covariance += influence * influence.transpose();
  }
  // Small-sample factor of the sandwich (residuals are smaller than errors by the unknowns that were fitted).
  const auto numbers = static_cast<double>(rows.Y.size());
  if (numbers > result.rank) result.covariance *= numbers / (numbers - result.rank);
  return result;
}

}  // namespace poecal
