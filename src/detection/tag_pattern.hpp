// What is known to be printed on a tag: black and white cells, and the corners of their outline.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace poecal {

/// The corner of an outline where the grey of its four cells does not cancel: a step of `weight` in the product of two half planes.
/// Growth g of dark into light moves it by g (shift_u, shift_v); where two dark cells meet corner to corner, two such turns part.
struct Turn {
  int weight = 0;  ///< white - black of the lower right cell, less that of its neighbours, plus that of the upper left; 0: none
  int shift_u = 0, shift_v = 0;
};

/// The column or row that a coordinate lies in: floor() within a few tags' widths, without a call into the mathematical library; elsewhere
/// one that is outside of any tag.
inline int cellAt(double coordinate) {
  constexpr int kFar = 64;
  return std::abs(coordinate) < kFar ? static_cast<int>(coordinate + kFar) - kFar : kFar;
}

/// Cells of a tag in its own plane: u right, v down, cell (i, j) covers [i, i + 1] x [j, j + 1].
class TagPattern {
 public:
  /// @param bare_corners  whether the margin's outer corner cells are as the family draws them; false: something else may be printed there
  /// (the squares between the tags of an aprilgrid).
  /// @param border_bits  width of the black border [cells]. @throws InvalidArgument as tagBitmap().
  TagPattern(const std::string& family, int id, bool bare_corners, int border_bits = 1);
  /// Any square of cells, all of them known; its corners are those of its outline.
  /// @param white  row by row from the top left, 1 white and 0 black. @pre white has width^2 numbers.
  TagPattern(int width, std::vector<int> white);

  int width() const { return width_; }
  /// Column k: corner k of the contract (bottom-left, bottom-right, top-right, top-left) [cells].
  const Eigen::Matrix<double, 2, 4>& corners() const { return corners_; }
  /// False outside of the pattern and where something else may be printed.
  bool isKnown(int column, int row) const;
  /// 1 white, 0 black; unknown cells count as white, the likeliest paper.
  int white(int column, int row) const { return isInside(column, row, width_) ? white_[indexOf(column, row, width_)] : 1; }
  /// Whether all cells that the box from `low` to `high` touches are of one grey.
  bool isUniform(const Eigen::Vector2d& low, const Eigen::Vector2d& high) const;
  bool contains(const Eigen::Vector2d& uv) const { return isInside(cellAt(uv.x()), cellAt(uv.y()), width_); }
  /// Whether the cell that (u, v) lies in and all others within `reach` along u and v [cells] are of one grey: isUniform() about a point
  /// inside of the pattern, from a table. Where the reach is a whole cell or more the answer is no.
  bool isUniformAbout(const Eigen::Vector2d& uv, const Eigen::Vector2d& reach) const {
    const int column = cellAt(uv.x()), row = cellAt(uv.y());
    const double u = uv.x() - column, v = uv.y() - row;
    const unsigned sides = (u < reach.x() ? kLeft : 0U) | (u + reach.x() >= 1.0 ? kRight : 0U) | (v < reach.y() ? kAbove : 0U) |
                           (v + reach.y() >= 1.0 ? kBelow : 0U);
    return ((uniform_[indexOf(column, row, width_)] >> sides) & 1U) != 0 && reach.maxCoeff() < 1.0;
  }
  /// The turns at the upper left corner of cell (column, row).
  const std::array<Turn, 2>& turns(int column, int row) const {
    static constexpr std::array<Turn, 2> kNone{};
    return isInside(column, row, width_ + 1) ? turns_[indexOf(column, row, width_ + 1)] : kNone;
  }

 private:
  /// Turns and uniform cells, from what is white.
  void tabulate();
  void setCorners(double corner_width);

  // What every pixel asks for many times is here, where callers can inline it.
  static bool isInside(int column, int row, int width) {
    return static_cast<unsigned>(column) < static_cast<unsigned>(width) && static_cast<unsigned>(row) < static_cast<unsigned>(width);
  }
  static std::size_t indexOf(int column, int row, int width) { return static_cast<std::size_t>(row * width + column); }

  static constexpr unsigned kLeft = 1, kRight = 2, kAbove = 4, kBelow = 8;

  int width_ = 0;
  bool bare_corners_ = true;
  std::vector<int> white_;                  ///< row by row from the top left
  std::vector<std::array<Turn, 2>> turns_;  ///< (width + 1)^2
  std::vector<std::uint16_t> uniform_;      ///< bit `sides` of a cell: it and its neighbours on those sides are of one grey
  Eigen::Matrix<double, 2, 4> corners_;
};

}  // namespace poecal
