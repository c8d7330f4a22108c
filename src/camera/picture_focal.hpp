// Pictures of one camera whose focal lengths differ: zoom and autofocus.
#pragma once

#include <string>
#include <vector>

#include "poecal/camera/intrinsics.hpp"

namespace poecal {

/// Fits a pose and a factor of fx and fy to each picture by itself, everything else of the camera held, and compares the factors.
/// @param residuals  of the views under the camera, with their poses.
/// @return a sentence that names pictures whose factor is farther than 2 % and eight standard deviations from the median; empty where
/// there are none.
/// @throws ImplausibleInput where these are more than a quarter of the pictures, with how large their factor is.
std::string otherFocalLengths(const Camera& camera, const std::vector<BoardView>& views, const std::vector<ViewResidual>& residuals);

}  // namespace poecal
