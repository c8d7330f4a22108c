// Whether the markers of a ChArUco board lie where the stated board has them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "poecal/target/target.hpp"

namespace poecal {

/// One sentence where the markers found contradict the board's number of squares a row (and with it the places of its ids), naming the
/// number that explains them; nothing where they agree, or are fewer than three.
/// @param markers  four corners each [px], clockwise from the upper left. @param ids  as many.
std::optional<std::string> layoutContradiction(const Target& board, const std::vector<std::vector<cv::Point2f>>& markers,
                                               const std::vector<int>& ids);

}  // namespace poecal
