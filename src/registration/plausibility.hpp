// Whether a registration can be that of the cell, and what is wrong with the input where it cannot.
#pragma once

#include <string>
#include <vector>

#include "registration/consensus.hpp"

namespace poecal {

/// Share of whole tags (corners 0..3 seen) whose corners run the wrong way round: an upright tag's corners run counter-clockwise in the
/// picture, and clockwise only in a mirrored picture, a mirrored print, or with another corner order.
double mirroredShare(const std::vector<Observation>& observations);

/// "the target is 0.800 +- 0.010 of its stated size".
std::string sizeText(double factor, double deviation);

/// Judges what a registration leaves by what the pictures leave with poses of their own, and by what is left where readings and pictures
/// have nothing to do with each other (random pairings). Where it is too much, single mistakes are undone and the same registration judges
/// each; one that mends it by a large factor is named.
/// @throws ImplausibleInput where a mistake explains it, or where nothing does and the registration is hardly better than chance.
void requirePlausible(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                      const Consensus& found);

/// Likewise of poses that are said to be those of the flange in base: with the cell's registration as it stands.
/// @throws ImplausibleInput as requirePlausible(), and where another registration explains them far better.
void requireRegistered(const Cell& cell, const std::vector<Observation>& observations);

}  // namespace poecal
