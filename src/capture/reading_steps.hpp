// Readings that were rounded: how coarsely, and what it costs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// A step that all readings of a joint are multiples of, up to a common offset.
struct ReadingStep {
  double size = 0.0;  ///< [rad], [m]
  std::string text;   ///< "0.01 rad", "1 degree", "1/4096 of a turn", "0.5 mm"
};

/// The coarsest step of one, two or five times a power of ten (radians, degrees; metres) or a turn over a power of two. Nothing where there
/// is none, or where fewer than eight values differ: a grid of poses looks the same.
std::optional<ReadingStep> readingStep(JointType type, std::vector<double> readings);

/// What the steps of all joints come to. Rounding moves each reading by at most half a step, and by step / sqrt(12) in root mean square.
struct Rounding {
  std::vector<std::optional<ReadingStep>> steps;  ///< of each joint
  double largest = 0.0;                           ///< way of the flange if all joints err the worst way, in the worst row [m]
  double rms = 0.0;                               ///< in the mean of the rows, sqrt(sum_k |dp/dq_k|^2 step_k^2 / 12) [m]

  /// Whether a joint's rounding is beyond what makers state of repeatability: below it nobody sees a step.
  bool isCoarse() const;
  /// step / sqrt(12) of each joint [rad], [m]; 0 where there is no step.
  Eigen::VectorXd sigmas() const;
  /// "q1 to q6 are multiples of 0.01 rad: rounded so, the flange is off by up to 12 mm (3.1 mm rms)"; the coarsest joints are named.
  std::string text() const;
};

/// @param samples  with joint readings of the arm.
Rounding roundingOf(const Arm& arm, const std::vector<Sample>& samples);

}  // namespace poecal
