// Random minimal sets: a registration that most samples agree on, however wrong the others are.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"

namespace poecal {

/// One sample as the search sees it: where the arm says it was, and the candidates of where the target was.
struct HypothesisSample {
  std::size_t observation = 0;
  Eigen::Isometry3d T_near_far = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> candidates;  ///< of T_camera_target, best first; may be empty for scoring only
  double free_misfit = 0.0;                   ///< what the best candidate leaves
};

/// How badly one observation fits a registration; larger is worse, infinity where it cannot be projected.
using Misfit = std::function<double(const Registration&, const HypothesisSample&)>;

struct Hypothesis {
  Registration registration;
  double score = 0.0;  ///< median misfit
};

/// Equal to 1e-6 rad and m: shots of one pose.
bool samePose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// Number of different poses (to 1e-6 rad and m) among the samples that have candidates, counted up to `enough`.
std::size_t differentPoses(const std::vector<HypothesisSample>& samples, std::size_t enough);

/// The best registrations found, best first, at most five. Deterministic.
std::vector<Hypothesis> searchRegistrations(Setup setup, const std::vector<HypothesisSample>& samples, const Misfit& misfit,
                                            int hypotheses);

}  // namespace poecal
