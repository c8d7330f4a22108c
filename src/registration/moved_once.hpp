// A camera or a target that was moved once during the capture: not a mistake in the input, but it looks like one.
#pragma once

#include <optional>

#include "registration/problem.hpp"

namespace poecal {

struct MovedOnce {
  std::size_t sample = 0;  ///< of the first row after the move
  double misfit = 0.0;     ///< median, with a registration for the rows before and another for those after
  double beside = 0.0;     ///< share of the rows that leave far more than that
};

/// Registers the first third of the rows and the last third each by itself. Every row between is then judged by both, and the move lies
/// where the two registrations together leave least. Nothing where there are too few rows for that.
std::optional<MovedOnce> findMove(const Problem& few);

}  // namespace poecal
