// What is known to be printed on a tag: black and white cells, and the corners of their outline.
#pragma once

#include <array>
#include <cstddef>
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

/// Cells of a tag in its own plane: u right, v down, cell (i, j) covers [i, i + 1] x [j, j + 1].
class TagPattern {
 public:
  /// @param bare_corners  whether the margin's outer corner cells are as the family draws them; false: something else may be printed there
  /// (the squares between the tags of an aprilgrid).
  /// @throws InvalidArgument for an unknown family or id.
  TagPattern(const std::string& family, int id, bool bare_corners);

  int width() const { return width_; }
  /// Column k: corner k of the contract (bottom-left, bottom-right, top-right, top-left) [cells].
  const Eigen::Matrix<double, 2, 4>& corners() const { return corners_; }
  /// False outside of the pattern and where something else may be printed.
  bool isKnown(int column, int row) const;
  /// 1 white, 0 black; unknown cells count as white, the likeliest paper.
  int white(int column, int row) const { return isInside(column, row, width_) ? white_[indexOf(column, row, width_)] : 1; }
  /// The turns at the upper left corner of cell (column, row).
  const std::array<Turn, 2>& turns(int column, int row) const {
    static constexpr std::array<Turn, 2> kNone{};
    return isInside(column, row, width_ + 1) ? turns_[indexOf(column, row, width_ + 1)] : kNone;
  }

 private:
  // What every pixel asks for many times is here, where callers can inline it.
  static bool isInside(int column, int row, int width) {
    return static_cast<unsigned>(column) < static_cast<unsigned>(width) && static_cast<unsigned>(row) < static_cast<unsigned>(width);
  }
  static std::size_t indexOf(int column, int row, int width) { return static_cast<std::size_t>(row * width + column); }

  int width_ = 0;
  bool bare_corners_ = true;
  std::vector<int> white_;                  ///< row by row from the top left
  std::vector<std::array<Turn, 2>> turns_;  ///< (width + 1)^2
  Eigen::Matrix<double, 2, 4> corners_;
};

}  // namespace poecal
