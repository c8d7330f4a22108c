// Rows that stand beside the pictures of other rows: shifted as a whole, or from some row on.
#pragma once

#include <optional>
#include <string>

#include "registration/problem.hpp"

namespace poecal {

struct MispairedRows {
  std::string text;                   ///< "the rows are shifted by one against the pictures"
  std::optional<std::size_t> sample;  ///< of the first row that is shifted, where those before it are not
  double misfit = 0.0;                ///< median, with every picture beside its own row
};

/// Registers with the readings of each row taken from up to five rows further up or down, and follows in the best of these which row each
/// picture belongs to. Something only where most pictures find their row and clearly fewer do as the rows stand.
/// @param few  the same observations, thinned.
std::optional<MispairedRows> findMispairedRows(const Cell& cell, const std::vector<Observation>& observations,
                                               const std::vector<HypothesisSample>& samples, const Problem& few);

}  // namespace poecal
