// Mistakes that were made in some of the rows: from some row on, up to one, or in rows here and there.
#pragma once

#include <optional>
#include <string>

#include "registration/problem.hpp"

namespace poecal {

struct WrongRows {
  std::string text;                   ///< "from this row on q5 counts the other way"
  std::size_t sample = 0;             ///< of the first row that is wrong; of rows that are wrong up to one, of the first that is right
  double misfit = 0.0, before = 0.0;  ///< medians of what the wrong rows leave, put right and as they stand
};

/// Rows that a registration of others contradicts, where one mistake that is undone in all of them brings them to it. The registration is
/// the given one, or that of the first or the last third or half of the rows: half of them may be wrong.
/// @param few  the same observations, thinned.
std::optional<WrongRows> findWrongRows(const Cell& cell, const std::vector<Observation>& observations,
                                       const std::vector<HypothesisSample>& samples, const Registration& registration, const Problem& few);

}  // namespace poecal
