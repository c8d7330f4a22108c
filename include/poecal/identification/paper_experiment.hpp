// The experiment of Gao, Wang and Jiang (2013), section 4: PUMA 560, 50 noisy poses, 50 others to judge, `gao` and `weighted` side by side.
#pragma once

#include <cstdint>
#include <vector>

#include "poecal/identification/identify.hpp"
#include "poecal/robot/arm.hpp"

namespace poecal {

struct PaperOptions {
  int seeds = 20;
  int poses = 50;
  int test_poses = 50;
  double noise_position = 5e-5;  ///< half width of the uniform noise of each coordinate [m]
  double noise_rotation = 1e-3;  ///< half width of the uniform noise of each component of a rotation vector, on the left [rad]
};

/// What one method made of one seed.
struct PaperFit {
  Arm arm;
  std::vector<double> residuals;        ///< gao: RMS of Y before the first step and after each, mm and rad mixed
  std::vector<FlangeError> test_poses;  ///< at each test pose, one pose an entry
  FlangeError error;                    ///< median over the test poses
};

struct PaperSeed {
  std::vector<FlangeError> nominal_test_poses;
  FlangeError nominal;
  PaperFit gao, weighted;
};

/// The measured poses of one seed: joints uniform in +-pi, and the flange of `actual` with noise.
PoseTable paperPoses(const Arm& actual, const PaperOptions& options, std::uint64_t seed);

/// Seeds 1..options.seeds.
std::vector<PaperSeed> paperExperiment(const Arm& nominal, const Arm& actual, const PaperOptions& options);

}  // namespace poecal
