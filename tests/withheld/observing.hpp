// What the camera of a case reports: true corners with noise, missing tags and rows that do not belong together; or pictures.
#pragma once

#include "withheld/case.hpp"

namespace withheld {

/// Share of rows whose joints and picture do not belong together, and of tags that are not seen.
struct Disorder {
  double wild_share = 0.0, missing_share = 0.0;
};

/// Fills sightings, wild and missing of a case, its unseen poses and their corners without noise.
void observe(Case& made, const Disorder& disorder, Chance& chance);

/// The same for a case that gives pictures: fills look, the unseen poses and their corners.
void observeByPictures(Case& made, Chance& chance);

}  // namespace withheld
