// Poses alone: whether the stated lens and the stated size of the target fit the pictures.
#pragma once

#include <string>
#include <vector>

#include "registration/consensus.hpp"

namespace poecal {

/// What to warn of where the arm's poses are the controller's own, so that no fit of the arm asks it later: the lens, with re-fitted
/// figures, or else the target's size. Each only where it is beyond chance (each picture counts as the six numbers of its pose) and lowers
/// the rms by a fifth.
/// @param registered  the cell with its registration.
/// @throws ImplausibleCapture: the target is off by more than a tenth of its size.
std::vector<std::string> checkLensAndSize(const Cell& registered, const std::vector<Observation>& observations,
                                          const std::vector<HypothesisSample>& samples);

}  // namespace poecal
