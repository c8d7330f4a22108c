// Corners of a chessboard pattern to a fraction of a pixel.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace poecal {

/// Moves each corner to the saddle of grey values in its window of 2 half + 1 pixels a side, where
/// half = what fits into `clearance` [px], the distance beyond which other edges would pull; between 2 and 11.
void refineSaddles(const cv::Mat& grey, std::vector<cv::Point2f>& corners, double clearance);

}  // namespace poecal
