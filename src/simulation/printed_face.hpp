// A printed plane of a target: cells of ink, paper and plate between straight lines.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

namespace poecal {

/// What a ray meets, in the order in which one lies on the other.
enum class Tile : std::uint8_t { kNone, kPlate, kPaper, kInk };

/// Areas of a piece of a face, one for each Tile, as shares of all of it.
using TileShares = std::array<double, 4>;

struct PaintedRectangle {
  Eigen::AlignedBox2d box;  ///< in the plane of the face [m]
  Tile tile = Tile::kNone;
};

/// A plane whose x points right, y down and z into it, seen from its front, divided into rectangular cells.
class PrintedFace {
 public:
  /// @param painted  at least one rectangle; later ones cover earlier ones. Cells that none covers are Tile::kNone.
  PrintedFace(const Eigen::Isometry3d& T_target_face, const std::vector<PaintedRectangle>& painted);

  const Eigen::Isometry3d& T_target_face() const { return T_target_face_; }
  /// Bounds of everything painted.
  Eigen::AlignedBox2d bounds() const;
  /// What is painted with a tile, as rectangles beside each other: runs of cells of each row [m].
  std::vector<Eigen::AlignedBox2d> runs(Tile tile) const;
  /// Index of the cell that holds a point of the plane; -1 outside the bounds. Cells are convex.
  int cellAt(double x, double y) const;
  /// What a convex quadrilateral of the plane, its corners in order around it, is painted with: polygons cut along the cells' borders.
  TileShares shares(const Eigen::Matrix<double, 2, 4>& corners) const;
  Tile tile(int cell) const { return cell < 0 ? Tile::kNone : cells_[static_cast<std::size_t>(cell)]; }

 private:
  Eigen::Isometry3d T_target_face_;
  std::vector<double> x_edges_, y_edges_;  ///< ascending [m]
  std::vector<Tile> cells_;                ///< row by row
};

}  // namespace poecal
