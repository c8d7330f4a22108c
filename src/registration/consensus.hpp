// The registration that most samples agree on, and how badly each sample fits one.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "poecal/cell/adjustment.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/core/progress.hpp"
#include "registration/hypotheses.hpp"

namespace poecal {

/// T_near_far of an observation: the flange as the cell models it, seen from the camera's side.
Eigen::Isometry3d nearFar(const Cell& cell, const Observation& observation);

/// sqrt(sum |r|^2 / N) over the corners of pictures [px]; infinity where one cannot be projected.
double cornerRms(const Cell& cell, std::span<const Observation> observations);
inline double cornerRms(const Cell& cell, const Observation& picture) { return cornerRms(cell, {&picture, 1}); }

/// Every observation with its candidates of T_camera_target: the poses that its corners leave open, or the measured pose (none where only a
/// position was measured).
/// @param progress  told of each observation; may be empty.
std::vector<HypothesisSample> hypothesisSamples(const Cell& cell, const std::vector<Observation>& observations,
                                                const ProgressFunction& progress = {});

/// How badly an observation fits: rms of its corners [px], or the whitened norm of its pose's residual.
Misfit misfitIn(const Cell& cell, const std::vector<Observation>& observations);

/// Both constant transforms free, everything else held.
AdjustmentOptions registrationAdjustment(bool robust);

struct Consensus {
  Adjustment fit;            ///< over all observations
  Registration closed_form;  ///< where it started
  double misfit = 0.0;       ///< median over the samples
};

struct ConsensusOptions {
  int hypotheses = 400;     ///< random minimal sets tried
  std::size_t refined = 5;  ///< the best of them that are adjusted, at most five
  bool robust = true;
  ProgressFunction progress = {};  ///< told of each that is adjusted; may be empty
};

/// The best hypotheses before any adjustment, best first.
std::vector<Hypothesis> searchHypotheses(const Cell& cell, const std::vector<Observation>& observations,
                                         const std::vector<HypothesisSample>& samples, int hypotheses);

/// The best of the refined hypotheses; nothing where no registration follows from the samples. Of samples whose misfits are judged by their
/// median, nearly half may be wrong. Deterministic.
std::optional<Consensus> findConsensus(const Cell& cell, const std::vector<Observation>& observations,
                                       const std::vector<HypothesisSample>& samples, const ConsensusOptions& options);

/// The median misfit of all samples in a registration.
double medianMisfit(const Registration& registration, const std::vector<HypothesisSample>& samples, const Misfit& misfit);

}  // namespace poecal
