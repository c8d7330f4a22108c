// Readings that stay exactly as they are while the arm moves on: an encoder, a column or a whole logger that is stuck.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/consensus.hpp"

namespace poecal {

/// Readings of a row beside those of the row before: of each joint, or the pose of the flange.
struct StuckReadings {
  std::string text;                   ///< "q5 stays at exactly 0.1234 from this row on"
  std::size_t sample = 0;             ///< of the first such row
  double misfit = 0.0, others = 0.0;  ///< medians of what these rows leave, and of what the others do
};

/// The rows in a run of equal readings, or the many that repeat the row before them, that a registration of all other rows contradicts.
/// Whoever commands a joint to stand still has such rows too, and they fit.
std::optional<StuckReadings> findStuckReadings(const Cell& cell, const std::vector<Observation>& observations,
                                               const std::vector<HypothesisSample>& samples);

/// "q3 and q4 hold the same readings in every row ..." of two joints that move; empty where there are none such.
std::string copiedColumns(const std::vector<Observation>& observations);

}  // namespace poecal
