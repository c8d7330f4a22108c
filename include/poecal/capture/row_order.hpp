// What the order of the rows tells where nobody recorded it.
#pragma once

#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// Which columns the order of the rows stands in for.
struct RowOrder {
  bool stamp = false;  ///< a row's number, from 0, is its time
  bool dir = false;    ///< sides from which the joints came are guessed
};

/// Rows are in the order taken. Where no sample has a stamp, that of row i (from 0) becomes i; where none has dirs, joint k is taken to
/// have come to row i straight from the row before,
///
///   dir_k,i = sign(q_k,i - q_k,i-1),
///
/// the side before it where the reading is the same, +1 at the first row. Columns that any sample has stay as they are.
RowOrder standInByRowOrder(std::vector<Sample>& samples);

}  // namespace poecal
