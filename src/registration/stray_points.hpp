// Points of a target that are not where it has them.
#pragma once

#include <optional>
#include <set>

#include "registration/problem.hpp"

namespace poecal {

/// Where the pictures show a point [m], each posed by its points that are not among `left_out`; nothing where fewer than four pictures
/// tell. @param p  where the target has it.
std::optional<Eigen::Vector3d> placeByTheOthers(const Problem& problem, PointId point, const std::set<PointId>& left_out,
                                                Eigen::Vector3d p);

/// Looks for points of a board, or of a target that lists many, without which the others fit with a pose of their own in each picture: at
/// most a third of them.
/// @throws ImplausibleCapture: what is left without them is a fifth of what it was, and they lie a quarter of the distance to the nearest
/// point or more from their places.
void requireEachPointFits(const Cell& cell, const std::vector<Observation>& observations);

}  // namespace poecal
