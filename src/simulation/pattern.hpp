// What is printed on each kind of target.
#pragma once

#include <vector>

#include "poecal/target/target.hpp"
#include "simulation/printed_face.hpp"

namespace poecal {

/// The printed planes of a target: one per tag, or one for a whole board, with a white margin and a plate around.
/// @throws InvalidArgument for a `points` target, an unknown family or dictionary, or an id that its family does not have.
std::vector<PrintedFace> printedFaces(const Target& target);

}  // namespace poecal
