// Effects that the contract's table does not have.
#pragma once

#include "withheld/cell.hpp"
#include "withheld/family.hpp"

namespace withheld {

/// One of a random kind at a random place, of usual size. @param shots  of the capture, for its hours.
Flaw strangeFlaw(const Cell& cell, const std::vector<Shot>& shots, Family family, Chance& chance);

/// Waves of three joint angles at one joint, sin(n.q + phase), |n_j| 1 to 4. The second family: two of them, of the same three joints.
Flaw waveOfThree(const Cell& cell, Family family, Chance& chance);

/// A smooth function of three joint angles at one joint that is no wave of theirs: bumps; in the second family, waves of broken factors.
Flaw fieldOfThree(const Cell& cell, Family family, Chance& chance);

/// What changes fast: camera or target sway with time, a joint has a saw or steps in its angle.
Flaw fastFlaw(const Cell& cell, const std::vector<Shot>& shots, Family family, Chance& chance);

}  // namespace withheld
