// The obvious collisions of an arm: its links as straight capsules against the camera, the line of sight, the floor and its own flange.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "poecal/cell/cell.hpp"
#include "poecal/planning/plan.hpp"

namespace poecal {

/// Distance between the segments a0 a1 and b0 b1 [m].
/// @see Ericson, Real-Time Collision Detection (2005), 5.1.9.
double segmentDistance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0, const Eigen::Vector3d& b1);

class Clearance {
 public:
  /// @param cell  the arm, and where camera and target are. @param gravity  in base [m/s^2].
  Clearance(const Cell& cell, const Eigen::Vector3d& gravity, const PlanOptions& options);

  /// Whether none of the obvious collisions is there at q.
  bool isFree(const Eigen::VectorXd& q) const;
  double linkRadius() const { return radius_; }

 private:
  /// Points of the arm at q, in base: base, every turning joint's anchor, the flange.
  std::vector<Eigen::Vector3d> points(const ArmChain& chain) const;

  Cell cell_;
  Eigen::Vector3d up_;
  double radius_ = 0.0, camera_radius_ = 0.0;
  std::optional<double> floor_;
};

}  // namespace poecal
