// What the pictures say of tags that are stated to stand still.
#pragma once

#include <string>
#include <vector>

#include "poecal/cell/observation.hpp"

namespace poecal {

/// Of a reference before a camera beside the arm: that too few pictures show it, or that it does not stand still there. One sentence each.
std::vector<std::string> remarksOnReference(const std::vector<Observation>& observations);

}  // namespace poecal
