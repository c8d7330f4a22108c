#include "simulation/pattern.hpp"

#include <algorithm>

#include "detection/marker_bitmap.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

using Painting = std::vector<PaintedRectangle>;

Eigen::AlignedBox2d boxAt(double x, double y, double width, double height) {
  return {Eigen::Vector2d(x, y), Eigen::Vector2d(x + width, y + height)};
}

Eigen::AlignedBox2d grown(const Eigen::AlignedBox2d& box, double margin) {
  return {(box.min().array() - margin).matrix(), (box.max().array() + margin).matrix()};
}

/// `inside` on white paper on a grey plate, each of which stands out by `margin`.
Painting sheet(const Eigen::AlignedBox2d& inside, double margin) {
  return {{grown(inside, 2.0 * margin), Tile::kPlate}, {grown(inside, margin), Tile::kPaper}};
}

/// Cells of a marker whose corners are `size` apart and whose centre is `center`; x right, y down.
void paintMarker(Painting& painting, const MarkerBitmap& bitmap, const Eigen::Vector2d& center, double size) {
  const double cell = size / bitmap.corner_width;
  const Eigen::Vector2d top_left = (center.array() - 0.5 * bitmap.width * cell).matrix();
  for (int row = 0; row < bitmap.width; ++row) {
    for (int column = 0; column < bitmap.width; ++column) {
      const Tile tile = bitmap.isWhite(column, row) ? Tile::kPaper : Tile::kInk;
      painting.push_back({boxAt(top_left.x() + column * cell, top_left.y() + row * cell, cell, cell), tile});
    }
  }
}

PrintedFace tagFace(const std::string& family, const TargetTag& tag) {
  const MarkerBitmap bitmap = tagBitmap(family, tag.id);
  const double cell = tag.size / bitmap.corner_width;
  const double width = cell * bitmap.width;
  Painting painting = sheet(boxAt(-width / 2.0, -width / 2.0, width, width), cell);
  paintMarker(painting, bitmap, Eigen::Vector2d::Zero(), tag.size);
  return {tag.T_target_tag, painting};
}

/// The whole grid in the plane of its first tag, whose x is right and y down, with Kalibr's black squares where the gaps cross. A border
/// that is not stated is of one cell.
PrintedFace aprilgridFace(const Target& target) {
  const Eigen::Isometry3d& T_target_face = target.tags.front().T_target_tag;
  const double size = target.tags.front().size;
  const double gap = target.tag_spacing * size;
  std::vector<Eigen::Vector2d> centers;
  Eigen::AlignedBox2d tags;
  for (const TargetTag& tag : target.tags) {
    centers.push_back((T_target_face.inverse() * tag.T_target_tag.translation()).head<2>());
    tags.extend(grown({centers.back(), centers.back()}, size / 2.0));
  }
  Painting painting = sheet(grown(tags, gap), gap);
  for (std::size_t k = 0; k < centers.size(); ++k) {
    paintMarker(painting, tagBitmap(target.family, target.tags[k].id, std::max(1, target.border_bits)), centers[k], size);
  }
  // Over the tags' white rings, so that squares touch the tags' corners as on Kalibr's sheets.
  for (int row = 0; row <= target.rows; ++row) {
    for (int column = 0; column <= target.cols; ++column) {
      const Eigen::Vector2d corner = (tags.min().array() - gap).matrix() + (size + gap) * Eigen::Vector2d(column, row);
      painting.push_back({boxAt(corner.x(), corner.y(), gap, gap), Tile::kInk});
    }
  }
  return {T_target_face, painting};
}

/// cols x rows squares from `top_left`, the top-left one black.
void paintSquares(Painting& painting, int cols, int rows, double square, const Eigen::Vector2d& top_left) {
  for (int row = 0; row < rows; ++row) {
    for (int column = row % 2; column < cols; column += 2) {
      painting.push_back({boxAt(top_left.x() + column * square, top_left.y() + row * square, square, square), Tile::kInk});
    }
  }
}

/// Squares around the inner corners; z = x cross y goes into the board.
PrintedFace chessboardFace(const Target& target) {
  const int cols = target.cols + 1, rows = target.rows + 1;
  const double square = target.square;
  Painting painting = sheet(boxAt(-square, -square, cols * square, rows * square), square);
  paintSquares(painting, cols, rows, square, {-square, -square});
  return {Eigen::Isometry3d::Identity(), painting};
}

/// OpenCV 4.6's layout: the top-left square is black, the white squares hold the markers 0, 1, ... row by row.
PrintedFace charucoFace(const Target& target) {
  const double square = target.square;
  Painting painting = sheet(boxAt(0.0, 0.0, target.cols * square, target.rows * square), square);
  paintSquares(painting, target.cols, target.rows, square, Eigen::Vector2d::Zero());
  int id = 0;
  for (int row = 0; row < target.rows; ++row) {
    for (int column = 1 - row % 2; column < target.cols; column += 2) {
      paintMarker(painting, arucoBitmap(target.dictionary, id++), {(column + 0.5) * square, (row + 0.5) * square}, target.marker);
    }
  }
  return {Eigen::Isometry3d::Identity(), painting};
}

}  // namespace

std::vector<PrintedFace> printedFaces(const Target& target) {
  switch (target.type) {
    case TargetType::kAprilTag: {
      std::vector<PrintedFace> faces;
      for (const TargetTag& tag : target.tags) faces.push_back(tagFace(target.family, tag));
      return faces;
    }
    case TargetType::kAprilGrid:
      return {aprilgridFace(target)};
    case TargetType::kCharuco:
      return {charucoFace(target)};
    case TargetType::kChessboard:
      return {chessboardFace(target)};
    case TargetType::kPoints:
      break;
  }
  throw InvalidArgument("a target of single points cannot be drawn, expected tags or a board");
}

}  // namespace poecal
