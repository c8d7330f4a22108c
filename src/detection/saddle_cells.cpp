#include "detection/saddle_cells.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace poecal {
namespace {

/// @param marker  whether white squares hold a dark marker, a cell away from their edges.
TagPattern patternOf(int middle, int cells_per_square, bool marker, DarkPair dark) {
  const int width = 2 * middle;
  std::vector<int> white;
  for (int row = 0; row < width; ++row) {
    for (int column = 0; column < width; ++column) {
      const auto square = [&](int k) { return (k + 2 * cells_per_square - middle) / cells_per_square - 2; };
      const bool same = (square(column) + square(row)) % 2 == 0;
      const auto beside = [&](int k) { return k == middle || k == middle - 1; };
      const bool is_light = same != (dark == DarkPair::kMain);
      white.push_back(is_light && !(marker && !beside(column) && !beside(row)) ? 1 : 0);
    }
  }
  return {width, std::move(white)};
}

}  // namespace

SaddleCells::SaddleCells(double cell, int middle, double margin, double known)
    : cell_(cell),
      middle_(middle),
      margin_(margin),
      known_(known),
      patterns_{patternOf(middle, std::isfinite(margin) ? middle : 1, std::isfinite(margin), DarkPair::kMain),
                patternOf(middle, std::isfinite(margin) ? middle : 1, std::isfinite(margin), DarkPair::kOther)} {}

SaddleCells SaddleCells::chessboard() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {1.0, 2, kInfinity, kInfinity};
}

SaddleCells SaddleCells::charuco(double margin, double border) {
  constexpr int kWidest = 31;  // patterns of more cells are more than cellAt() knows
  return {margin, std::min(kWidest, static_cast<int>(std::ceil(1.0 / margin))), margin, margin + border};
}

}  // namespace poecal
