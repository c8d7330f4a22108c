#include "detection/tag_pattern.hpp"

#include <cassert>
#include <utility>

#include "detection/marker_bitmap.hpp"

namespace poecal {
namespace {

/// Turns of the four cells a b / c d about a point. One cell unlike the other three: a dark one grows over the point, a white one draws
/// back. Cells alike corner to corner: both white ones draw back.
std::array<Turn, 2> turnsOf(int a, int b, int c, int d) {
  const int weight = a - b - c + d;
  const int whites = a + b + c + d;
  if (weight == 0) return {};
  if (whites == 2) {
    if (a == 1) return {Turn{1, -1, -1}, Turn{1, 1, 1}};
    return {Turn{-1, 1, -1}, Turn{-1, -1, 1}};
  }
  const int odd = whites == 1 ? 1 : 0;  // the grey of the cell unlike the others
  const int side_u = b == odd || d == odd ? 1 : -1;
  const int side_v = c == odd || d == odd ? 1 : -1;
  const int outward = odd == 1 ? 1 : -1;
  return {Turn{weight, outward * side_u, outward * side_v}, Turn{}};
}

}  // namespace

TagPattern::TagPattern(const std::string& family, int id, bool bare_corners, int border_bits) : bare_corners_(bare_corners) {
  const MarkerBitmap bitmap = tagBitmap(family, id, border_bits);
  width_ = bitmap.width;
  for (int row = 0; row < width_; ++row) {
    for (int column = 0; column < width_; ++column) white_.push_back(bitmap.isWhite(column, row) || !isKnown(column, row) ? 1 : 0);
  }
  tabulate();
  setCorners(bitmap.corner_width);
}

TagPattern::TagPattern(int width, std::vector<int> white) : width_(width), white_(std::move(white)) {
  assert(white_.size() == static_cast<std::size_t>(width * width));
  tabulate();
  setCorners(width);
}

void TagPattern::tabulate() {
  for (int row = 0; row <= width_; ++row) {
    for (int column = 0; column <= width_; ++column) {
      turns_.push_back(turnsOf(white(column - 1, row - 1), white(column, row - 1), white(column - 1, row), white(column, row)));
    }
  }
  for (int row = 0; row < width_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const Eigen::Vector2d middle(column + 0.5, row + 0.5);
      unsigned uniform = 0;
      for (unsigned sides = 0; sides < 16; ++sides) {
        const Eigen::Vector2d low((sides & kLeft) != 0 ? -1.0 : 0.0, (sides & kAbove) != 0 ? -1.0 : 0.0);
        const Eigen::Vector2d high((sides & kRight) != 0 ? 1.0 : 0.0, (sides & kBelow) != 0 ? 1.0 : 0.0);
        uniform |= isUniform(middle + low, middle + high) ? 1U << sides : 0U;
      }
      uniform_.push_back(static_cast<std::uint16_t>(uniform));
    }
  }
}

void TagPattern::setCorners(double corner_width) {
  const double low = 0.5 * (width_ - corner_width);
  const double high = low + corner_width;
  corners_ << low, high, high, low,  //
      high, high, low, low;
}

bool TagPattern::isKnown(int column, int row) const {
  const int last = width_ - 1;
  if (column < 0 || row < 0 || column > last || row > last) return false;
  return bare_corners_ || !((column == 0 || column == last) && (row == 0 || row == last));
}

bool TagPattern::isUniform(const Eigen::Vector2d& low, const Eigen::Vector2d& high) const {
  const int left = cellAt(low.x()), right = cellAt(high.x()), bottom = cellAt(high.y());
  int row = cellAt(low.y());
  const int here = white(left, row);
  for (; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      if (white(column, row) != here) return false;
    }
  }
  return true;
}

}  // namespace poecal
