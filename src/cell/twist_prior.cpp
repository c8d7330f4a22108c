#include "poecal/cell/twist_prior.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

// Where a drive's zero is, only its maker's mark tells: far more than any bias that is left after homing [rad] or [m].
constexpr double kZeroOffset = 0.02;

/// beta of a joint for a small motion l of its whole surrounding, xi <- Ad(exp(l)) xi: what of l really moves the axis.
Eigen::MatrixXd axisMotion(const Joint& joint) {
  const Matrix6Xd moved = adjointOfTwist(joint.xi) * twistBasis(joint);
  return moved.colPivHouseholderQr().solve(adjointOfTwist(joint.xi));
}

/// Motion of the parameters of all axes behind joint k by a motion of the link that it moves, parameters x 6.
Eigen::MatrixXd movesBehind(const Arm& arm, std::size_t k) {
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(twistParameterCount(arm), 6);
  int row = 0;
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    const int size = twistParameterCount(arm.joints[j]);
    if (j > k) moves.middleRows(row, size) = axisMotion(arm.joints[j]);
    row += size;
  }
  return moves;
}

}  // namespace

TwistPrior::TwistPrior(const Arm& arm, double position, double rotation, bool base_known) : arm_(arm) {
  const int count = twistParameterCount(arm);
  const std::size_t links = arm.joints.size() - 1;
  // Half of the variance is of the axis itself, half of the link before it.
  own_variance_.resize(count);
  int row = 0;
  for (const Joint& joint : arm.joints) {
    for (int k = 0; k < twistParameterCount(joint); ++k, ++row) own_variance_(row) = 0.5 * std::pow(k < 2 ? rotation : position, 2);
  }
  link_variance_ << Eigen::Vector3d::Constant(0.5 * rotation * rotation), Eigen::Vector3d::Constant(0.5 * position * position);
  zero_moves_.resize(count, static_cast<Eigen::Index>(links));
  zero_variance_ = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(links), kZeroOffset * kZeroOffset);
  if (!base_known && links > 0) zero_variance_(0) = 0.0;
  Eigen::MatrixXd covariance = own_variance_.asDiagonal();
  for (std::size_t k = 0; k < links; ++k) {
    const Eigen::MatrixXd moves = movesBehind(arm, k);
    // The link's own frame stands in the anchor of the joint that moves it, where a tilt is only a tilt.
    Vector6d shift = Vector6d::Zero();
    shift.tail<3>() = arm.joints[k].anchor;
    link_moves_.push_back(moves * adjoint(expSe3(shift)));
    covariance += link_moves_.back() * link_variance_.asDiagonal() * link_moves_.back().transpose();
    const Eigen::VectorXd zero = moves * arm.joints[k].xi;
    zero_moves_.col(static_cast<Eigen::Index>(k)) = zero;
    covariance += zero_variance_(static_cast<Eigen::Index>(k)) * zero * zero.transpose();
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
  precision = llt.solve(Eigen::MatrixXd::Identity(llt.rows(), llt.cols()));
  log_determinant = -2.0 * llt.matrixLLT().diagonal().array().log().sum();
}

std::vector<JointDeviation> TwistPrior::deviations(const Eigen::VectorXd& beta) const {
  // E(part | beta) = Cov(part, beta) Cov(beta)^-1 beta
  const Eigen::VectorXd pull = precision * beta;
  std::vector<JointDeviation> all(arm_.joints.size());
  int row = 0;
  for (std::size_t j = 0; j < all.size(); ++j) {
    const int size = twistParameterCount(arm_.joints[j]);
    Eigen::VectorXd local = own_variance_.segment(row, size).cwiseProduct(pull.segment(row, size));
    if (j > 0) {
      const Eigen::MatrixXd& moves = link_moves_[j - 1];
      local += moves.middleRows(row, size) * link_variance_.cwiseProduct(moves.transpose() * pull);
    }
    all[j].tilt = local.head<2>().norm();
    all[j].shift = local.tail(size - 2).norm();
    const auto zero = static_cast<Eigen::Index>(j);
    if (zero < zero_variance_.size()) all[j].zero = zero_variance_(zero) * zero_moves_.col(zero).dot(pull);
    row += size;
  }
  return all;
}

double updatedTolerance(const TwistPrior& prior, const Eigen::VectorXd& beta, const Eigen::MatrixXd& covariance, double before) {
  if (prior.empty()) return 1.0;
  const double spread = beta.dot(prior.precision * beta);
  const double known = static_cast<double>(beta.size()) - prior.precision.cwiseProduct(covariance).sum() / (before * before);
  return std::clamp(std::sqrt(spread / std::max(known, 1.0)), 1.0, 1e3);
}

}  // namespace poecal
