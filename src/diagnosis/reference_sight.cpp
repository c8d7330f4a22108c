#include "diagnosis/reference_sight.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "poecal/core/statistics.hpp"
#include "poecal/registration/target_pose.hpp"

namespace poecal {
namespace {

constexpr std::size_t kFewestPictures = 4;
constexpr std::size_t kFewestCorners = 4;

/// An observation's reference as what evaluateRows() reads.
Observation sightOf(const Observation& observation) {
  Observation sight;
  sight.corners = observation.reference;
  return sight;
}

/// One picture of the reference.
struct Sight {
  std::size_t place = 0;   ///< among the rows' observations
  std::size_t number = 0;  ///< among the measured ones, in the order taken
  Cell cell;               ///< the camera alone, as it is disturbed
  Observation observation;
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  Matrix6d weight = Matrix6d::Zero();  ///< H' H
  Vector6d score = Vector6d::Zero();   ///< H' r
  Vector6d motion = Vector6d::Zero();  ///< of the mount, by this picture alone
  double squares = 0.0;
};

void evaluate(const Eigen::Isometry3d& T_camera_reference, Sight& sight) {
  SampleRows rows;
  evaluateRows(sight.cell, sight.observation, sight.mount * T_camera_reference, false, rows);
  sight.weight = rows.H.transpose() * rows.H;
  sight.score = rows.H.transpose() * rows.r;
  sight.squares = rows.r.squaredNorm();
}

/// Evaluates all pictures at the one pose that serves them best, by Gauss-Newton from that which a picture shows. False where there is
/// none.
bool evaluateAtCommonPose(std::vector<Sight>& sights) {
  const std::vector<TargetPose> poses = targetPoses(*sights.front().cell.camera, sights.front().observation);
  if (poses.empty()) return false;
  Eigen::Isometry3d T = sights.front().mount.inverse() * poses.front().T_camera_target;
  constexpr int kSteps = 20;
  constexpr double kSettled = 1e-10;
  for (int step = 0; step < kSteps; ++step) {
    Matrix6d weight = Matrix6d::Zero();
    Vector6d score = Vector6d::Zero();
    for (Sight& sight : sights) {
      evaluate(T, sight);
      weight += sight.weight;
      score += sight.score;
    }
    const Vector6d change = weight.ldlt().solve(score);
    if (!change.allFinite()) return false;
    T = expSe3(change) * T;
    if (change.norm() < kSettled) break;
  }
  for (Sight& sight : sights) {
    evaluate(T, sight);
    sight.motion = sight.weight.ldlt().solve(sight.score);
  }
  return true;
}

/// Variance of the noise in units of the stated one: that of the corners about a pose of each picture's own, or, from the median, that of
/// the differences between pictures that follow each other.
double varianceOf(const std::vector<Sight>& sights) {
  double squares = 0.0, spare = 0.0;
  std::vector<double> differences;
  for (std::size_t k = 0; k < sights.size(); ++k) {
    const Sight& sight = sights[k];
    squares += sight.squares - sight.score.dot(sight.motion);
    spare += 2.0 * static_cast<double>(sight.observation.corners.size()) - 6.0;
    if (k == 0) continue;
    const Sight& before = sights[k - 1];
    const Vector6d difference = sight.motion - before.motion;
    const Matrix6d covariance = sight.weight.inverse() + before.weight.inverse();
    differences.push_back(difference.dot(covariance.ldlt().solve(difference)));
  }
  constexpr double kLeast = 1e-12;  // of corners without noise
  return std::max({kLeast, squares / spare, median(differences) / chiSquareQuantile(0.5, 6)});
}

}  // namespace

ReferenceSight::ReferenceSight(const MeasuredCell& measured, const Cell& cell, const std::vector<AppliedEffect>& effects,
                               const CaptureRows& rows) {
  if (!cell.camera || cell.registration.setup != Setup::kEyeToHand) return;
  std::vector<Sight> sights;
  for (std::size_t k = 0; k < rows.observations.size(); ++k) {
    const SampleContext& context = rows.observations[k].context;
    const Observation& observation = measured.observations[context.number];
    if (observation.reference.size() < kFewestCorners) continue;
    const Disturbance disturbance = effects.empty() ? Disturbance() : disturbanceOf(effects, context);
    Sight sight{.place = k, .number = context.number, .cell = {}, .observation = sightOf(observation)};
    sight.cell.camera = disturbedCamera(cell, disturbance);
    sight.mount = expSe3(disturbance.mount);
    sights.push_back(std::move(sight));
  }
  if (sights.size() < kFewestPictures) return;
  std::sort(sights.begin(), sights.end(), [](const Sight& a, const Sight& b) { return a.number < b.number; });
  if (!evaluateAtCommonPose(sights)) return;
  const double variance = varianceOf(sights);
  pictures_ = sights.size();
  weights_.assign(rows.observations.size(), Matrix6d::Zero());
  motions_ = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(rows.observations.size()));
  Matrix6d total = Matrix6d::Zero();
  for (const Sight& sight : sights) {
    weights_[sight.place] = sight.weight / variance;
    motions_.segment<6>(6 * static_cast<Eigen::Index>(sight.place)) = sight.motion;
    total += weights_[sight.place];
  }
  total_inverse_ = total.inverse();
}

Eigen::MatrixXd ReferenceSight::motionsOf(const Candidate& candidate, const CaptureRows& rows) const {
  if (empty() || !candidate.moves_reference) return {};
  Eigen::MatrixXd motions = actionsOf(candidate, rows, 0, rows.observations.size());
  for (std::size_t k = 0; k < rows.observations.size(); ++k) {
    auto of_picture = motions.middleRows<6>(6 * static_cast<Eigen::Index>(k));
    of_picture = rows.observations[k].ports.mount.partialPivLu().solve(Eigen::MatrixXd(of_picture)).eval();
  }
  return motions;
}

Eigen::VectorXd ReferenceSight::weighted(const Eigen::VectorXd& motion) const {
  Eigen::VectorXd all(motion.size());
  Vector6d sum = Vector6d::Zero();
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(k);
    all.segment<6>(row) = weights_[k] * motion.segment<6>(row);
    sum += all.segment<6>(row);
  }
  const Vector6d common = total_inverse_ * sum;
  for (std::size_t k = 0; k < weights_.size(); ++k) all.segment<6>(6 * static_cast<Eigen::Index>(k)) -= weights_[k] * common;
  return all;
}

Eigen::MatrixXd ReferenceSight::information(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd all(a.cols(), b.cols());
  for (Eigen::Index k = 0; k < b.cols(); ++k) all.col(k) = a.transpose() * weighted(b.col(k));
  return all;
}

Eigen::VectorXd ReferenceSight::score(const Eigen::MatrixXd& a) const { return a.transpose() * weighted(motions_); }

void ReferenceSight::take(const Eigen::VectorXd& motion) { motions_ -= motion; }

double ReferenceSight::misfit() const { return motions_.dot(weighted(motions_)); }

}  // namespace poecal
