// Cells of calib_data as a plan sees them: identified from random poses, with the truth at hand.
#pragma once

#include <string>
#include <vector>

#include "identification/simulated_cell.hpp"
#include "poecal/planning/plan.hpp"

namespace poecal::test {

/// A cell as known, and as it is.
struct PlannedCell {
  PlanningCell cell;
  Cell truth;
  Identification identification;
};

/// Identified from `poses` random visible poses. The stated tolerances are those with which its axes were drawn.
PlannedCell plannedCell(const std::string& name, std::uint64_t seed, int poses);

/// The same cell, identified again from the pictures so far and pictures of `poses` with kSigma of noise.
PlannedCell withPictures(const PlannedCell& planned, const std::vector<PlannedPose>& poses, std::uint64_t seed);

/// What a capture of the same poses would have known of an arm that has an effect beside its geometry: corners moved by it, and the
/// effect in the model.
PlanningCell withEffect(const PlannedCell& planned, const EffectSpec& spec);

/// Adds pictures of the true arm with an effect to what was taken.
void addPictures(const Cell& truth, const EffectSpec& spec, const std::vector<PlannedPose>& poses, std::uint64_t seed, PlanningCell& cell);

/// As many random visible poses, as scenes draw them.
std::vector<PlannedPose> randomPoses(const std::string& name, std::uint64_t seed, int count);

/// Root mean square error of the tool over the workspace of plans [m].
double toolError(const PlannedCell& planned);

}  // namespace poecal::test
