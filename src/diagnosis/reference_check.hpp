// Whether tags that are stated to stand still do.
#pragma once

#include <string>
#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"

namespace poecal {

/// A camera that moves, moves everything in its picture by about as much. Where the reference moves ten times as far as the target is from
/// where the arm puts it (the 90 % of the pictures with the least of each; and 10 px), it is the reference that does not stand still. One
/// sentence; empty where it does, or where there is none.
std::string referenceContradiction(const Cell& identified, const std::vector<Observation>& observations);

}  // namespace poecal
