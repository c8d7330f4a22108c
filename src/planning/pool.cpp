#include "planning/pool.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cell/visible_poses.hpp"

namespace poecal {
namespace {

constexpr long kDrawsPerPose = 400;  ///< in all: one posture in 400 that shows the target is enough
constexpr int kRoughPlaces = 20;
constexpr int kMostUnseen = 2;  ///< of these in which the target may be out of view

std::uint64_t streamOf(PoolPurpose purpose, std::size_t number) {
  return (static_cast<std::uint64_t>(purpose) << 32) | static_cast<std::uint64_t>(number);
}

bool inPicture(const Camera& camera, const Eigen::Vector3d& p_camera) {
  const auto px = project(camera, p_camera);
  return px && px->x() > -0.5 && px->y() > -0.5 && px->x() < camera.width - 0.5 && px->y() < camera.height - 0.5;
}

Vector6d roughMotion(const PlanningCell& cell, Rng& rng) {
  Vector6d motion;
  for (int i = 0; i < 6; ++i) motion(i) = (i < 3 ? cell.rough_rotation : cell.rough_position) * rng.normal();
  return motion;
}

}  // namespace

Pool::Pool(const PlanningCell& cell, const PlanOptions& options)
    : cell_(cell),
      options_(options),
      ranges_(readingRanges(*cell.model.cell.arm, cell.robot_file)),
      clearance_(cell.model.cell, cell.taken.gravity, options) {
  for (const TargetPoint& point : cell.target.points) centre_target_ += point.p_target / static_cast<double>(cell.target.points.size());
  if (!(cell.rough_position > 0.0 || cell.rough_rotation > 0.0)) return;
  Rng rng(options.seed, streamOf(PoolPurpose::kRough, 0));
  for (int k = 0; k < kRoughPlaces; ++k) {
    Registration& place = rough_.emplace_back(cell.model.cell.registration);
    place.T_camera_near = place.T_camera_near * expSe3(roughMotion(cell, rng));
    place.T_far_target = place.T_far_target * expSe3(roughMotion(cell, rng));
  }
}

bool Pool::isVisible(const Sample& sample) const {
  // The model's effects move the target by far less than the margins of what is well in view.
  const Camera& camera = *cell_.model.cell.camera;
  const Eigen::Isometry3d T_base_flange = forwardKinematics(*cell_.model.cell.arm, sample.q);
  const Eigen::Isometry3d T_camera_target = cell_.model.cell.registration.cameraTarget(T_base_flange);
  // Most postures show nothing: where the middle of the target has no pixel in the picture, all of it is not looked for.
  if (!inPicture(camera, T_camera_target * centre_target_) || !wellInView(camera, cell_.target, T_camera_target)) return false;
  if (!clearance_.isFree(sample.q)) return false;
  if (rough_.empty()) return true;
  int unseen = 0;
  for (const Registration& place : rough_) {
    if (!wellInView(camera, cell_.target, place.cameraTarget(T_base_flange)) && ++unseen > kMostUnseen) return false;
  }
  return true;
}

std::vector<Sample> Pool::visible(PoolPurpose purpose, std::size_t number, int count, long* drawn, Progress* told) const {
  Rng rng(options_.seed, streamOf(purpose, number));
  const Sample to_come = sampleToCome(cell_, ranges_.empty() ? Eigen::VectorXd() : drawReading(ranges_, rng));
  std::vector<Sample> found;
  long tried = 0;
  for (; tried < kDrawsPerPose * count && static_cast<int>(found.size()) < count; ++tried) {
    if (told != nullptr && tried % kDrawsPerPose == 0) told->show();
    Sample sample = to_come;
    sample.q = drawReading(ranges_, rng);
    for (double& side : sample.dir) side = rng.below(2) == 0 ? -1.0 : 1.0;
    if (!isVisible(sample)) continue;
    found.push_back(std::move(sample));
    if (told != nullptr) told->advance();
  }
  if (drawn != nullptr) *drawn = tried;
  return found;
}

std::vector<Sample> Pool::near(const Sample& sample, double share, std::size_t number, int count) const {
  Rng rng(options_.seed, streamOf(PoolPurpose::kNear, number));
  std::vector<Sample> found;
  for (int k = 0; k < count; ++k) {
    Sample other = sample;
    const std::size_t alone = rng.below(ranges_.size());
    for (std::size_t joint = 0; joint < ranges_.size(); ++joint) {
      const double step = share * (ranges_[joint].upper - ranges_[joint].lower) * rng.normal();
      const double side = rng.below(2) == 0 ? -1.0 : 1.0;
      const auto j = static_cast<Eigen::Index>(joint);
      if (k % 2 == 1 && joint != alone) continue;
      other.q(j) = std::clamp(other.q(j) + step, ranges_[joint].lower, ranges_[joint].upper);
      other.dir(j) = side;
    }
    if (isVisible(other)) found.push_back(std::move(other));
  }
  return found;
}

std::vector<Sample> Pool::anywhere(int count) const {
  Rng rng(1, streamOf(PoolPurpose::kWorkspace, 0));  // one workspace for all plans, so that their figures compare
  std::vector<Sample> samples;
  for (int k = 0; k < count; ++k) samples.push_back(sampleToCome(cell_, drawReading(ranges_, rng)));
  return samples;
}

std::vector<std::size_t> pathOrder(const std::vector<Eigen::VectorXd>& poses, const Eigen::VectorXd& from,
                                   const std::vector<JointLimits>& ranges) {
  const auto joints = static_cast<Eigen::Index>(ranges.size());
  Eigen::VectorXd width(joints), at(joints);
  for (Eigen::Index k = 0; k < joints; ++k) {
    const JointLimits& range = ranges[static_cast<std::size_t>(k)];
    width(k) = std::max(range.upper - range.lower, 1e-9);
    at(k) = 0.5 * (range.lower + range.upper);
  }
  if (from.size() == joints) at = from;
  Eigen::VectorXd balance = Eigen::VectorXd::Zero(joints);  // times each joint came from below, less those from above
  std::vector<std::size_t> order;
  std::vector<bool> done(poses.size(), false);
  while (order.size() < poses.size()) {
    std::size_t next = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < poses.size(); ++k) {
      if (done[k]) continue;
      const Eigen::VectorXd move = (poses[k] - at).cwiseQuotient(width);
      const double evens = -move.cwiseSign().dot(balance.cwiseSign()) / static_cast<double>(std::max<Eigen::Index>(joints, 1));
      constexpr double kWorth = 1.0 / 3.0;
      const double length = move.norm() * (1.0 - kWorth * evens);
      if (length >= least) continue;
      least = length;
      next = k;
    }
    balance += (poses[next] - at).cwiseSign();
    at = poses[next];
    done[next] = true;
    order.push_back(next);
  }
  return order;
}

}  // namespace poecal
