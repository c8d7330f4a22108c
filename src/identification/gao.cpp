#include "identification/gao.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>
#include <Eigen/SVD>

#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

/// The six rows of one pose.
struct PoseRows {
  Eigen::Matrix<double, 6, Eigen::Dynamic> L;
  Vector6d y;
};

/// All rows, L = Q R and Q^T Y, of which the steps need no more than R and z = (Q^T Y)_head: as few numbers for ten thousand poses as for
/// ten.
struct ReducedRows {
  Eigen::MatrixXd R;
  Eigen::VectorXd z;
  double square_sum = 0.0;  ///< |Y|^2
  Eigen::Index count = 0;

  double rms() const { return std::sqrt(square_sum / static_cast<double>(count)); }
};

/// The equations of all poses about an arm.
class Equations {
 public:
  Equations(const Arm& arm, const std::vector<Eigen::VectorXd>& q, const std::vector<Eigen::Isometry3d>& T_base_flange, double length_unit)
      : arm_(arm), q_(q), T_base_flange_(T_base_flange), length_unit_(length_unit), twists_(twistParameterCount(arm)) {}

  std::size_t poseCount() const { return q_.size(); }

  PoseRows poseRows(std::size_t k) const {
    const ArmChain chain = forwardChain(arm_, q_[k]);
    PoseRows rows{Eigen::Matrix<double, 6, Eigen::Dynamic>(6, twists_ + 6), logSe3(T_base_flange_[k] * chain.T_base_flange.inverse())};
    rows.L.leftCols(twists_) = twistJacobian(arm_, Eigen::VectorXd::Zero(twists_), arm_, chain, q_[k]);
    rows.L.rightCols<6>() = adjoint(chain.P.back()) * leftJacobianSe3(arm_.gamma);
    rows.y.tail<3>() /= length_unit_;
    rows.L.bottomRows<3>() /= length_unit_;
    return rows;
  }

  ReducedRows reduced() const {
    constexpr std::size_t kPosesAtOnce = 64;
    const int columns = twists_ + 6;
    ReducedRows reduced;
    // R and z of the poses so far, and below them the next ones.
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(columns + 6 * kPosesAtOnce, columns + 1);
    for (std::size_t first = 0; first < poseCount(); first += kPosesAtOnce) {
      const std::size_t count = std::min(kPosesAtOnce, poseCount() - first);
      for (std::size_t k = 0; k < count; ++k) {
        const PoseRows rows = poseRows(first + k);
        both.middleRows<6>(columns + 6 * static_cast<Eigen::Index>(k)) << rows.L, rows.y;
        reduced.square_sum += rows.y.squaredNorm();
      }
      const auto used = both.topRows(columns + 6 * static_cast<Eigen::Index>(count));
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(used);
      both.topRows(columns) = qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
    }
    reduced.R = both.topLeftCorner(columns, columns);
    reduced.z = both.col(columns).head(columns);
    reduced.count = 6 * static_cast<Eigen::Index>(poseCount());
    return reduced;
  }

 private:
  const Arm& arm_;
  const std::vector<Eigen::VectorXd>& q_;
  const std::vector<Eigen::Isometry3d>& T_base_flange_;
  double length_unit_;
  int twists_;
};

/// The sum over all poses of what each pulls at the unknowns, (L^T L)^+ L_k^T y_k, times itself transposed.
Eigen::MatrixXd sandwich(const Equations& equations, const Eigen::MatrixXd& normal_inverse) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(normal_inverse.rows(), normal_inverse.cols());
  for (std::size_t k = 0; k < equations.poseCount(); ++k) {
    const PoseRows rows = equations.poseRows(k);
    const Eigen::VectorXd influence = normal_inverse * (rows.L.transpose() * rows.y);
    sum += influence * influence.transpose();
  }
  return sum;
}

}  // namespace

GaoResult gao(const Arm& nominal, const std::vector<Eigen::VectorXd>& q, const std::vector<Eigen::Isometry3d>& T_base_flange,
              const GaoOptions& options) {
  GaoResult result;
  result.arm = nominal;
  const auto equationsOf = [&](const Arm& arm) { return Equations(arm, q, T_base_flange, options.length_unit); };
  ReducedRows rows = equationsOf(nominal).reduced();
  result.residuals.push_back(rows.rms());
  const int twists = twistParameterCount(nominal);
  Eigen::VectorXd scale;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr(rows.R.rows(), rows.R.cols());
  for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
    scale = rows.R.colwise().norm().transpose().unaryExpr([](double n) { return n > 0.0 ? 1.0 / n : 1.0; });
    qr.setThreshold(1e-10);
    qr.compute(rows.R * scale.asDiagonal());
    if (iteration == options.max_iterations) break;
    const Eigen::VectorXd x = scale.cwiseProduct(qr.solve(rows.z));
    Arm next = displaceTwists(result.arm, x.head(twists));
    next.gamma += x.tail<6>();
    ReducedRows next_rows = equationsOf(next).reduced();
    // Rounding, or the noise floor: further steps only stir the last digits.
    if (!(next_rows.rms() < result.residuals.back() * (1.0 - 1e-9))) {
      result.converged = true;
      break;
    }
    result.residuals.push_back(next_rows.rms());
    result.arm = std::move(next);
    rows = std::move(next_rows);
  }
  result.rank = static_cast<int>(qr.rank());
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(rows.R * scale.asDiagonal()).singularValues();
  result.condition_number = singular(0) / singular(result.rank - 1);
  const Eigen::MatrixXd scaled_inverse = scale.asDiagonal() * qr.pseudoInverse();
  result.covariance = sandwich(equationsOf(result.arm), scaled_inverse * scaled_inverse.transpose());
  // Small-sample factor of the sandwich (residuals are smaller than errors by the unknowns that were fitted).
  const auto numbers = static_cast<double>(rows.count);
  if (numbers > result.rank) result.covariance *= numbers / (numbers - result.rank);
  return result;
}

}  // namespace poecal
