// Poses held out in turn: which of them a fit does not see, and what the rest then have to foretell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "diagnosis/capture_rows.hpp"

namespace poecal {

/// How the poses of a fold belong together.
enum class HeldOut {
  kRandom,   ///< not at all: the rest lie among them
  kTime,     ///< they follow each other: what drifts or moves meanwhile is foretold from before and after
  kPosture,  ///< their joint readings are near each other: what hangs on the posture is foretold from other postures
};

/// Numbers of the groups of each fold, ascending. Every group is in one fold, no fold is empty.
using Folds = std::vector<std::vector<std::size_t>>;

/// At least 2 folds, at most as many as there are groups. Stamps give the order of time where all groups have one, otherwise the rows do.
/// @param seed  of the random ones; the others are the same for every seed.
Folds makeFolds(const MeasuredCell& measured, HeldOut kind, int folds, std::uint64_t seed);

}  // namespace poecal
