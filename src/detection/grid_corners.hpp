// The corners of an aprilgrid as one board: what contradicts the board goes, and where Kalibr's black squares touch the tags, their saddles
// are the corners.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "poecal/capture/detections.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// Makes the corners of single tags those of a grid.
///
/// Tags with a corner more than a tenth of a side away from the homography that most tags agree on are dropped. Where the sheet has black
/// squares in the crossings of its gaps, libapriltag loses tags and corners by pixels, since a square touches each corner; but each corner
/// is then a saddle like a chessboard's: all of the grid's corners in the picture are searched as such, from where the homography expects
/// them. Saddles state a sigma of 0.03 px.
/// @param corners  sorted by id, of the grid's tags; replaced. Fewer than two tags stay as they are.
void settleGridCorners(const Target& grid, const cv::Mat& grey, std::vector<Corner>& corners);

}  // namespace poecal
