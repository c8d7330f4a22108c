// One tag of several that is not as the target's file says.
#pragma once

#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"

namespace poecal {

/// Places each tag by the others: their pose in every picture foretells its corners, and what these are off by is fitted as another size,
/// place and turn of the tag. Only targets of 2 to 8 tags are looked at: boards of many are printed as one. Of two tags no other place in
/// their plane counts: which of them lies elsewhere nobody knows, and it is an effect (target_layout).
/// @throws ImplausibleCapture: with one tag of another size (3 %), place (a tenth of its size; in its plane half of it where there is an
/// arm) or turn (0.1 rad) the free poses leave less than a third of what they leave now. Smaller ones in the plane are for the diagnosis to
/// say (target_layout).
void requireEachTagFits(const Cell& cell, const std::vector<Observation>& observations);

}  // namespace poecal
