// Effects that the contract's table does not have.
#pragma once

#include "withheld/cell.hpp"

namespace withheld {

/// One of a random kind at a random place, of usual size. @param shots  of the capture, for its hours.
Flaw strangeFlaw(const Cell& cell, const std::vector<Shot>& shots, Chance& chance);

}  // namespace withheld
