// What is printed about an inner corner of a chessboard or a ChArUco board.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Core>

#include "detection/tag_pattern.hpp"

namespace poecal {

/// Which two of the four squares about a corner are dark: those at its upper left and lower right (towards the first and towards the last
/// corner of the board), or the others.
enum class DarkPair { kMain = 0, kOther = 1 };

/// Cells about a corner, which is the middle of the pattern. A chessboard's are its squares, four by four. A ChArUco board's are as wide as
/// the margin between a marker and its square; the black border of the markers is known, what is inside of it is not.
class SaddleCells {
 public:
  static SaddleCells chessboard();
  /// @param margin  between the edges of a square and of its marker. @param border  width of the marker's black border. Both in squares.
  static SaddleCells charuco(double margin, double border);

  const TagPattern& pattern(DarkPair dark) const { return patterns_[static_cast<std::size_t>(dark)]; }
  double cell() const { return cell_; }   ///< [squares]
  int middle() const { return middle_; }  ///< the corner's cell coordinates
  /// Whether a place relative to the corner [squares] is within `reach` of what is not known, along both directions.
  bool isHidden(const Eigen::Vector2d& squares, const Eigen::Vector2d& reach, DarkPair dark) const {
    const Eigen::Vector2d inside = squares.cwiseAbs() + reach;
    const bool light = (squares.x() * squares.y() > 0.0) != (dark == DarkPair::kMain);
    return light && inside.minCoeff() > known_;
  }
  /// Distance along one direction to the nearest line that may have an edge [squares].
  double toLine(double squares) const { return std::min(std::abs(squares), std::abs(std::abs(squares) - margin_)); }

 private:
  SaddleCells(double cell, int middle, double margin, double known);

  double cell_;
  int middle_;
  double margin_;  ///< infinite: there are no markers
  double known_;   ///< from the corner to the end of what is known in a white square, along both directions [squares]
  std::array<TagPattern, 2> patterns_;
};

}  // namespace poecal
