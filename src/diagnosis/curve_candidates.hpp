// What nobody listed as candidates: a smooth curve of every driver at every place.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "diagnosis/candidates.hpp"

namespace poecal {

/// The joint through whose readings the capture went in order, so that what changes with time looks like what the joint drives; nothing
/// where there is none, or some time is not known. By Spearman's rank correlation of reading and time.
std::optional<std::size_t> orderingJoint(const std::vector<Sample>& samples);

/// Curves of all drivers that the samples have, at each joint, both mounts and the lens, with their shares of what explains a gap.
/// @param contexts  of the samples, at the cell as it is. @param ordered_by  CandidateList::ordered_by: that joint then stands for time,
/// and nothing comes and goes with time, which would look like what the other joints drive.
std::vector<Candidate> curveCandidates(const MeasuredCell& measured, const std::vector<SampleContext>& contexts,
                                       const std::optional<std::size_t>& ordered_by);

}  // namespace poecal
