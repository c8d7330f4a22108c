// The target that a user states against the corners that the pictures show.
#pragma once

#include "registration/problem.hpp"

namespace poecal {

/// A target as stated fits every picture with a pose of its own, whatever robot and readings are. Nothing is required of poses, nor of
/// fewer than four pictures.
/// @throws ImplausibleCapture: it does not fit, and another order of its corners or tags, or another distance of them, does; or one of
/// its tags or points does not fit the others (one_tag.hpp, stray_points.hpp); or a board whose columns and rows are exchanged does.
void requireTargetFits(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples);

}  // namespace poecal
