#include "poecal/identification/errors.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "cell/linearisation.hpp"
#include "poecal/core/random.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// Variances of the components of all poses' errors.
struct ErrorVariances {
  double rotation = 1e-2, position = 1e-2;  ///< [rad^2], [m^2]; to begin with, far more than any arm is off

  Matrix6d precision() const {
    Vector6d diagonal;
    diagonal << Eigen::Vector3d::Constant(1.0 / rotation), Eigen::Vector3d::Constant(1.0 / position);
    return diagonal.asDiagonal();
  }
};

/// What is known of one pose's error.
struct ErrorEstimate {
  Vector6d mean;
  Eigen::Vector2d traces;  ///< of the covariance: rotation, position

  ErrorEstimate(const FlangeEvidence& evidence, const Matrix6d& precision) {
    const Matrix6d covariance = (evidence.information + precision).llt().solve(Matrix6d::Identity());
    mean = covariance * evidence.pull;
    traces << covariance.topLeftCorner<3, 3>().trace(), covariance.bottomRightCorner<3, 3>().trace();
  }
};

/// The variances that so many poses could not have told from none: the median of what the likelihood leaves above 0, from its curvature
/// there.
ErrorVariances leastTold(const std::vector<FlangeEvidence>& evidence, const ErrorVariances& at) {
  constexpr double kMedianOfHalfNormal = 0.6745;
  double rotation = 0.0, position = 0.0;
  for (const FlangeEvidence& each : evidence) {
    const Eigen::Matrix3d rr = each.information.topLeftCorner<3, 3>(), pp = each.information.bottomRightCorner<3, 3>(),
                          rp = each.information.topRightCorner<3, 3>();
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    rotation += 0.5 * (rr - rp * (pp + one / at.position).inverse() * rp.transpose()).squaredNorm();
    position += 0.5 * (pp - rp.transpose() * (rr + one / at.rotation).inverse() * rp).squaredNorm();
  }
  return {kMedianOfHalfNormal / std::sqrt(rotation), kMedianOfHalfNormal / std::sqrt(position)};
}

ErrorVariances estimateVariances(const std::vector<FlangeEvidence>& evidence) {
  constexpr std::size_t kEnough = 500;  // poses: two variances are then known to a twentieth
  constexpr int kMaxSteps = 100;
  constexpr double kSettled = 1e-3, kFewest = 1e-6, kSmallest = 1e-18;
  constexpr double kWild = 25.0;  // times the median: five times as far as most, which none in 10^10 is by chance
  const std::size_t step = std::max<std::size_t>(1, evidence.size() / kEnough);
  ErrorVariances variances;
  for (int k = 0; k < kMaxSteps; ++k) {
    const Matrix6d precision = variances.precision();
    std::vector<ErrorEstimate> estimates;
    std::vector<double> sizes;
    for (std::size_t i = 0; i < evidence.size(); i += step) {
      const ErrorEstimate& estimate = estimates.emplace_back(evidence[i], precision);
      sizes.push_back(estimate.mean.dot(precision * estimate.mean));
    }
    // A wild row is no draw of what the others are drawn from.
    const double most = kWild * median(sizes);
    Eigen::Vector2d squares(0.0, 0.0), known(0.0, 0.0);
    for (std::size_t i = 0; i < estimates.size(); ++i) {
      if (sizes[i] > most) continue;
      const ErrorEstimate& estimate = estimates[i];
      squares += Eigen::Vector2d(estimate.mean.head<3>().squaredNorm(), estimate.mean.tail<3>().squaredNorm());
      known += Eigen::Vector2d(3.0 - estimate.traces(0) / variances.rotation, 3.0 - estimate.traces(1) / variances.position);
    }
    const ErrorVariances next{std::max(squares(0) / std::max(known(0), kFewest), kSmallest),
                              std::max(squares(1) / std::max(known(1), kFewest), kSmallest)};
    const bool settled = std::abs(std::log(next.rotation / variances.rotation)) < kSettled &&
                         std::abs(std::log(next.position / variances.position)) < kSettled;
    variances = next;
    if (settled) break;
  }
  const ErrorVariances least = leastTold(evidence, variances);
  return {std::max(variances.rotation, least.rotation), std::max(variances.position, least.position)};
}

/// @param H  d(model)/d(T_camera_target), left perturbation in camera. @param r  residuals; both in stated sigmas.
FlangeEvidence flangeEvidence(const Cell& cell, const Eigen::Isometry3d& T_camera_target, const Eigen::Matrix<double, Eigen::Dynamic, 6>& H,
                              const Eigen::VectorXd& r, double noise) {
  const Registration& registration = cell.registration;
  const Eigen::Isometry3d T_base_flange = registration.baseFlange(T_camera_target);
  // A rotation about the flange and a shift of it, as a left perturbation in base, then in camera.
  Matrix6d D = Matrix6d::Identity();
  D.bottomLeftCorner<3, 3>() = hat(T_base_flange.translation());
  const double sign = registration.setup == Setup::kEyeToHand ? 1.0 : -1.0;
  const Eigen::Matrix<double, Eigen::Dynamic, 6> J = sign / noise * H * (adjoint(registration.cameraBase(T_base_flange)) * D);
  return {J.transpose() * J, J.transpose() * r / noise};
}

/// What a pose is off, (rad; m), from its residual in stated sigmas.
Vector6d poseError(const PoseMeasurement& pose, const Eigen::VectorXd& r) {
  Vector6d e = Vector6d::Zero();
  if (!pose.whitening.isZero(0.0)) e.tail(r.size()) = pose.whitening.bottomRightCorner(r.size(), r.size()).partialPivLu().solve(r);
  return e;
}

}  // namespace

LengthSummary summarise(const std::vector<double>& lengths) {
  if (lengths.empty()) return {};
  return {mean(lengths), median(lengths), rms(lengths), quantile(lengths, 0.95), *std::max_element(lengths.begin(), lengths.end())};
}

std::pair<double, double> rmsInterval(const std::vector<PoseSquares>& poses) {
  constexpr int kResamples = 1000;
  std::vector<double> values;
  Rng rng(1);
  for (int resample = 0; resample < kResamples && !poses.empty(); ++resample) {
    PoseSquares sum;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const PoseSquares& pose = poses[rng.below(poses.size())];
      sum.squares += pose.squares;
      sum.points += pose.points;
    }
    if (sum.points > 0.0) values.push_back(std::sqrt(sum.squares / sum.points));
  }
  if (values.empty()) return {0.0, 0.0};
  return {quantile(values, 0.025), quantile(values, 0.975)};
}

std::vector<FlangeError> expectedFlangeErrors(const std::vector<FlangeEvidence>& evidence) {
  const Matrix6d precision = estimateVariances(evidence).precision();
  std::vector<FlangeError> errors;
  errors.reserve(evidence.size());
  for (const FlangeEvidence& each : evidence) {
    const ErrorEstimate estimate(each, precision);
    errors.push_back({.position = std::sqrt(estimate.mean.tail<3>().squaredNorm() + estimate.traces(1)),
                      .rotation = std::sqrt(estimate.mean.head<3>().squaredNorm() + estimate.traces(0))});
  }
  return errors;
}

void ErrorCollector::add(const Cell& cell, std::size_t index, const Observation& observation) {
  const Eigen::Isometry3d T_camera_target = modelTarget(cell, observation);
  SampleRows rows;
  evaluateRows(cell, observation, T_camera_target, false, rows);
  addRow(cell, index, observation, T_camera_target, rows, rows.r);
}

void ErrorCollector::add(const Cell& cell, std::size_t index, const Observation& observation, const Eigen::Isometry3d& T_camera_target,
                         const Eigen::VectorXd& r) {
  SampleRows rows;
  evaluateRows(cell, observation, T_camera_target, false, rows);
  addRow(cell, index, observation, T_camera_target, rows, r);
}

void ErrorCollector::addRow(const Cell& cell, std::size_t index, const Observation& observation, const Eigen::Isometry3d& T_camera_target,
                            const SampleRows& rows, const Eigen::VectorXd& r) {
  RowErrors row;
  row.index = index;
  row.whitened_squares = r.squaredNorm();
  if (observation.pose) {
    const Vector6d e = poseError(*observation.pose, r);
    row.measured = {e.tail<3>().norm(), e.head<3>().norm()};
    row.lengths.push_back(row.measured.position);
    poses_ = true;
    rotations_ = rotations_ && !observation.pose->position_only;
  } else {
    for (std::size_t j = 0; j < observation.corners.size(); ++j) {
      if (rows.valid[j]) row.lengths.push_back(observation.corners[j].sigma_px * r.segment<2>(2 * static_cast<Eigen::Index>(j)).norm());
    }
    row.evidence = flangeEvidence(cell, T_camera_target, rows.H, r, noise_);
  }
  rows_.push_back(std::move(row));
}

ErrorSummary ErrorCollector::summary(const std::function<bool(std::size_t)>& counts) const {
  std::vector<double> px;
  std::vector<FlangeEvidence> evidence;
  std::vector<FlangeError> errors;
  for (const RowErrors& row : rows_) {
    if (counts && !counts(row.index)) continue;
    evidence.push_back(row.evidence);
    errors.push_back(row.measured);
    if (!poses_) px.insert(px.end(), row.lengths.begin(), row.lengths.end());
  }
  ErrorSummary summary;
  summary.poses = static_cast<int>(errors.size());
  if (!poses_ && !evidence.empty()) errors = expectedFlangeErrors(evidence);
  std::vector<double> positions, rotations;
  for (const FlangeError& error : errors) {
    positions.push_back(error.position);
    if (rotations_) rotations.push_back(error.rotation);
  }
  summary.corners = static_cast<int>(px.size());
  summary.px = summarise(px);
  summary.position = summarise(positions);
  summary.rotation = summarise(rotations);
  return summary;
}

}  // namespace poecal
