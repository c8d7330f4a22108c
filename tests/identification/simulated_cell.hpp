// Cells of calib_data with errors and poses drawn by seed, as observations and as truth.
#pragma once

#include <string>
#include <vector>

#include "poecal/identification/identify.hpp"
#include "poecal/simulation/simulate.hpp"

namespace poecal::test {

/// A scene of calib_data with other errors and poses for each seed, as observations and as truth.
struct Simulated {
  Cell truth;
  Cell nominal;
  Target target;
  std::vector<Observation> calibration, unseen;

  /// The calibration corners, each pose by itself. Their deviations count as not stated, so that their scale is estimated.
  Measurements measurements() const;
};

constexpr double kSigma = 0.1;  ///< stated, and that of the calibration corners [px]

/// Corners of `count` poses of a scene with `sigma` of noise.
std::vector<Observation> observe(const Scene& scene, std::uint64_t seed, int count, double sigma);

/// @param unseen  poses with exact corners.
Simulated simulated(const std::string& name, std::uint64_t seed, int poses, int unseen);

/// Bundle without held-out poses and with the camera as it is.
IdentifyOptions plainBundle();

}  // namespace poecal::test
