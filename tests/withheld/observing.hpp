// What the camera of a case reports: true corners with noise, missing tags and rows that do not belong together.
#pragma once

#include "withheld/case.hpp"

namespace withheld {

/// Fills sightings, wild, missing of a case, and the corners of its unseen poses (without noise).
/// @param scatter_joint, scatter  a joint (from 0) that comes to rest anywhere within this much [rad or m, 1 sigma]; 0: none does.
struct Disorder {
  double wild_share = 0.0, missing_share = 0.0;
};
void observe(Case& made, const Disorder& disorder, Chance& chance);

}  // namespace withheld
