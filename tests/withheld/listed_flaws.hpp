// The withheld world's own versions of the effects in the contract's table.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "withheld/cell.hpp"

namespace withheld {

/// Which instances are wanted of effects that have a time or an order.
struct Instances {
  double slip_time = 0.0;                           ///< [s]
  std::vector<int> orders = {2, 3, 4, 5, 6, 7, 8};  ///< of harmonics
};

/// Every listed effect that can be at some place of a cell and that its columns can show, with all sizes zero. Without the random ones and
/// target_scale, which have sets of their own.
std::vector<Flaw> listedFlaws(const Cell& cell, const Columns& columns, const Instances& instances);

/// A flaw that yields to gravity (joint_compliance, link_bending, base_compliance) of an arm whose masses nobody knows: one parameter for
/// each body's mass, and for its mass one metre along each of its axes, times each of the flaw's own; any masses are a sum of these.
Flaw withUnknownMasses(const Cell& cell, const Flaw& flaw);

/// A joint (from 0) that comes to rest anywhere within `sigma` of where it should, drawn anew at each pose.
Flaw jointScatter(const Cell& cell, std::size_t joint, std::uint64_t seed);

/// A joint whose zero is off: nothing but another geometry.
Flaw zeroOffset(std::size_t joint, double offset);

/// Tags printed larger (share > 0) or smaller than said.
Flaw targetScale(double share);

}  // namespace withheld
