// What is suspected where no registration explains the pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"

namespace poecal {

/// Share of whole tags (corners 0..3 seen) whose corners run the wrong way round: an upright tag's corners run counter-clockwise in the
/// picture, and clockwise only in a mirrored picture, a mirrored print, or with another corner order.
double mirroredShare(const std::vector<Observation>& observations);

/// Tries what people get wrong (joints in degrees, the other setup) and says which of it would explain the pictures.
/// @param misfit_px  what the best registration left. @param misfitOf  the same of an altered cell and its observations.
std::optional<std::string> suspectedMistake(const Cell& cell, const std::vector<Observation>& observations, double misfit_px,
                                            double (*misfitOf)(const Cell&, const std::vector<Observation>&));

}  // namespace poecal
