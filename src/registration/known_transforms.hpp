// Transforms that are known before anything is measured, weighed in with what the poses show.
#pragma once

#include <string>
#include <vector>

#include "registration/consensus.hpp"

namespace poecal {

/// Whether nothing has to be searched: all of both transforms is known.
bool knowsBoth(const Registration& registration);

/// A registration that begins where both transforms are known to be, for poses that do not turn enough to find them.
/// @throws ImplausibleCapture where the poses fit far better with one of the two elsewhere.
Consensus consensusAsKnown(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                           bool robust);

/// Fits once more with what is known of the transforms. @param known  the cell whose registration says so.
/// @return what the poses contradict, one sentence each: a transform that they put clearly elsewhere than it is said to be.
/// @throws ImplausibleCapture where the poses fit far worse for it: they are then of another cell, or in other units.
std::vector<std::string> weighInKnown(const Cell& known, const std::vector<Observation>& observations,
                                      const std::vector<HypothesisSample>& samples, bool robust, Consensus& found);

}  // namespace poecal
