// The inner corners of one board in one picture, each fitted to the grey values about it.
#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "detection/saddle_cells.hpp"

namespace poecal {

struct BoardSaddle {
  int col = 0, row = 0;
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< [px] per axis
};

/// fitSaddle() for each corner, the board about it taken from where its neighbours are, in whatever lens. A corner that cannot be fitted
/// (it moves by more than two pixels, has a contrast of less than 20 grey levels, or residuals that are no noise) stays where it is and
/// states five times the median sigma of the others, at least 0.1 px, and at least how far it is from where its neighbours
/// expect it; so does one that is more than half a pixel from there and whose fit is as uncertain.
/// @param grey  8-bit, one channel. @param saddles  about right; fewer than four, or all on a line, stay where they are and state 0.1 px.
/// @param first  which squares are dark about corner (0, 0).
void fitBoardSaddles(const cv::Mat& grey, const SaddleCells& cells, DarkPair first, std::vector<BoardSaddle>& saddles);

}  // namespace poecal
