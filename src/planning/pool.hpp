// Random postures that show the target well and are apart from the obvious collisions: what a plan is chosen from and held against.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "planning/clearance.hpp"
#include "planning/knowledge.hpp"

namespace poecal {

/// Independent random sequences of one seed.
enum class PoolPurpose : std::uint64_t { kCandidates = 1, kRandom, kWorkspace, kRough, kNear };

class Pool {
 public:
  Pool(const PlanningCell& cell, const PlanOptions& options);

  /// Up to `count` visible postures, as sequence `number` of a purpose draws them. @param drawn  if given, set to how many were tried.
  /// @param told  if given, advanced for each, and shown while none is found.
  std::vector<Sample> visible(PoolPurpose purpose, std::size_t number, int count, long* drawn = nullptr, Progress* told = nullptr) const;
  /// Visible postures near a posture: every joint moved by a normal draw of `share` of its range, half of them one joint alone. @param
  /// number of the sequence.
  std::vector<Sample> near(const Sample& sample, double share, std::size_t number, int count) const;
  const Clearance& clearance() const { return clearance_; }
  /// Postures uniform within the joint limits, in view or not.
  std::vector<Sample> anywhere(int count) const;

 private:
  bool isVisible(const Sample& sample) const;

  const PlanningCell& cell_;
  const PlanOptions& options_;
  std::vector<JointLimits> ranges_;
  Clearance clearance_;
  Eigen::Vector3d centre_target_ = Eigen::Vector3d::Zero();
  std::vector<Registration> rough_;  ///< where camera and target may be instead; empty where they are known
};

/// A short path: from `from` always on to the nearest pose (joint motion in units of the joints' ranges), where a pose that is reached with
/// joints turning the way that they did less often so far counts as nearer by up to a third. @param from  empty: the middle of the ranges.
std::vector<std::size_t> pathOrder(const std::vector<Eigen::VectorXd>& poses, const Eigen::VectorXd& from,
                                   const std::vector<JointLimits>& ranges);

}  // namespace poecal
