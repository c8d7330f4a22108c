// How far a model is from what was measured, in pixels, millimetres and milliradians.
#pragma once

#include <cstddef>
#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"

namespace poecal {

/// Mean, median, root mean square and maximum of lengths.
struct LengthSummary {
  double mean = 0.0, median = 0.0, rms = 0.0, max = 0.0;
};

/// Errors of a set of poses.
struct ErrorSummary {
  int poses = 0;
  int corners = 0;
  LengthSummary px;        ///< length of a corner's residual [px]; zero for poses
  LengthSummary position;  ///< flange (corners), or the measured point (poses) [m]
  LengthSummary rotation;  ///< [rad]; zero where only positions were measured
};

/// Errors of single observations, collected over folds and summarised once.
class ErrorCollector {
 public:
  /// @param T_camera_target  the target's free pose where corners were measured; nullptr where there is none.
  void add(const Cell& cell, const Observation& observation, const Eigen::Isometry3d* T_camera_target);
  ErrorSummary summary() const;
  /// Sum of squared pixel (or whitened pose) residuals of each observation added, in order.
  const std::vector<double>& squares() const { return squares_; }

 private:
  std::vector<double> px_, position_, rotation_, squares_;
};

LengthSummary summarise(const std::vector<double>& lengths);

}  // namespace poecal
