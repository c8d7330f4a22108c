// Joints' ports as the rows see them pose by pose, and how well waves there serve stretches of poses that were left out.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "diagnosis/evidence.hpp"

namespace poecal {

/// A joint's turning in each pose, with p its whitened column there, X and r the whitened columns and residual of the linearisation.
struct PortSums {
  Eigen::VectorXd weight;    ///< |p|^2
  Eigen::VectorXd residual;  ///< p'r
  Eigen::MatrixXd cross;     ///< X'p, one column a pose
};

/// Sums of a linearisation by joint and by stretch of poses: all that cross-validating columns of the form p phi needs.
class WaveFolds {
 public:
  WaveFolds(const MeasuredCell& measured, const Linearised& linear);

  std::size_t joints() const { return ports_.size(); }
  const PortSums& port(std::size_t joint) const { return ports_[joint]; }

  /// How many of some waves at a joint, taken in their order, serve poses best that lie in stretches which the fit did not see; 0 where
  /// none does. @param shapes  cos and sin of each at the poses. @param variances  of the factors of each, before the rows are looked at.
  std::size_t bestCount(std::size_t joint, const std::vector<Eigen::MatrixX2d>& shapes, const std::vector<double>& variances) const;

 private:
  std::vector<PortSums> ports_;
  std::vector<Eigen::Index> begin_;       ///< pose with which each stretch begins, and the end
  std::vector<Eigen::MatrixXd> squares_;  ///< [X r]'[X r] of each stretch
  ColumnPrior prior_;                     ///< of X
};

}  // namespace poecal
