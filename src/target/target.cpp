#include "poecal/target/target.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>
#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "target/names.hpp"

namespace poecal {
namespace {

/// Far beyond any board; keeps a typing error from filling the memory.
constexpr int kMaxPerSide = 1000;

constexpr double kLargestSide = 3.0;  ///< [m] of a tag or a square; in millimetres the smallest ones are larger

void checkLength(double value, const char* name) {
  if (value > kLargestSide && std::isfinite(value)) {
    throw InvalidArgument(fmt::format("{} is {} m, expected at most {} m: millimetres?", name, value, kLargestSide));
  }
  if (!(value > 0.0) || !std::isfinite(value)) throw InvalidArgument(fmt::format("{} is {}, expected a positive length in m", name, value));
}

void checkCount(int value, int smallest, const char* name) {
  if (value < smallest || value > kMaxPerSide) {
    throw InvalidArgument(fmt::format("{} is {}, expected {} to {}", name, value, smallest, kMaxPerSide));
  }
}

void checkTagId(int id, const IdSet& family) {
  if (id < 0 || id >= family.count) {
    throw InvalidArgument(fmt::format("tag id {} does not exist, {} has ids 0 to {}", id, family.name, family.count - 1));
  }
}

void sortPoints(Target& target) {
  std::sort(target.points.begin(), target.points.end(), [](const TargetPoint& a, const TargetPoint& b) { return a.id < b.id; });
  const auto repeated = std::adjacent_find(target.points.begin(), target.points.end(),
                                           [](const TargetPoint& a, const TargetPoint& b) { return a.id == b.id; });
  if (repeated != target.points.end()) {
    const char* kind = target.type == TargetType::kPoints ? "point" : "tag";
    throw InvalidArgument(fmt::format("{} id {} is there twice, expected each once", kind, repeated->id.tag));
  }
}

void addTagCorners(Target& target) {
  for (const TargetTag& tag : target.tags) {
    const Eigen::Matrix<double, 3, 4> corners = tagCorners(tag.size);
    for (int corner = 0; corner < 4; ++corner) target.points.push_back({{tag.id, corner}, tag.T_target_tag * corners.col(corner)});
  }
  sortPoints(target);
}

/// cols x rows points, x along a row; the first at `origin`.
void addBoardCorners(Target& target, int cols, int rows, const Eigen::Vector3d& origin) {
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      target.points.push_back({{-1, row * cols + col}, origin + target.square * Eigen::Vector3d(col, row, 0.0)});
    }
  }
}

}  // namespace

const TargetPoint* Target::find(PointId id) const {
  const auto found =
      std::lower_bound(points.begin(), points.end(), id, [](const TargetPoint& point, PointId key) { return point.id < key; });
  return found != points.end() && found->id == id ? &*found : nullptr;
}

bool Target::planar() const {
  constexpr double kTolerance = 1e-9;  // [m]; far below any target's flatness, far above the rounding of coordinates of metres
  if (points.size() < 4) return true;
  Eigen::Matrix3Xd centred(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) centred.col(static_cast<Eigen::Index>(k)) = points[k].p_target;
  const Eigen::Vector3d mean = centred.rowwise().mean();
  centred.colwise() -= mean;
  // Through the 3 x 3 scatter the smallest direction would be lost below 1e-8 of the largest; the SVD of the points themselves keeps it.
  const Eigen::JacobiSVD<Eigen::MatrixX3d> svd(centred.transpose(), Eigen::ComputeFullV);
  const Eigen::Vector3d normal = svd.matrixV().col(2);
  return (normal.transpose() * centred).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kTolerance;
}

Eigen::Matrix<double, 3, 4> tagCorners(double size) {
  const double h = size / 2.0;
  Eigen::Matrix<double, 3, 4> corners;
  corners << -h, h, h, -h,  //
      h, h, -h, -h,         //
      0.0, 0.0, 0.0, 0.0;
  return corners;
}

Target apriltagTarget(const std::string& family, const std::vector<TargetTag>& tags) {
  const IdSet& ids = findIdSet(tagFamilies(), family, "tag family");
  if (tags.empty()) throw InvalidArgument("a target without tags, expected one or more");
  for (const TargetTag& tag : tags) {
    checkTagId(tag.id, ids);
    checkLength(tag.size, "size of a tag");
  }
  Target target;
  target.type = TargetType::kAprilTag;
  target.family = family;
  target.tags = tags;
  addTagCorners(target);
  return target;
}

Target chessboardTarget(int cols, int rows, double square) {
  // OpenCV finds no board with fewer than 3 inner corners a side.
  checkCount(cols, 3, "cols");
  checkCount(rows, 3, "rows");
  checkLength(square, "square");
  Target target;
  target.type = TargetType::kChessboard;
  target.cols = cols;
  target.rows = rows;
  target.square = square;
  addBoardCorners(target, cols, rows, Eigen::Vector3d::Zero());
  return target;
}

Target charucoTarget(int cols, int rows, double square, double marker, const std::string& dictionary) {
  const IdSet& ids = findIdSet(markerDictionaries(), dictionary, "dictionary");
  checkCount(cols, 2, "cols");
  checkCount(rows, 2, "rows");
  checkLength(square, "square");
  checkLength(marker, "marker");
  if (marker >= square) throw InvalidArgument(fmt::format("marker is {}, expected less than square, {}", marker, square));
  if (cols * rows / 2 > ids.count) {
    throw InvalidArgument(
        fmt::format("a board of {} x {} squares has {} markers, {} only {}", cols, rows, cols * rows / 2, ids.name, ids.count));
  }
  Target target;
  target.type = TargetType::kCharuco;
  target.cols = cols;
  target.rows = rows;
  target.square = square;
  target.marker = marker;
  target.dictionary = dictionary;
  addBoardCorners(target, cols - 1, rows - 1, Eigen::Vector3d(square, square, 0.0));
  return target;
}

Target aprilgridTarget(const std::string& family, int cols, int rows, double tag_size, double tag_spacing, int first_id, int border_bits) {
  const IdSet& ids = findIdSet(tagFamilies(), family, "tag family");
  checkCount(cols, 1, "tagCols");
  checkCount(rows, 1, "tagRows");
  checkLength(tag_size, "tagSize");
  if (!(tag_spacing > 0.0) || !std::isfinite(tag_spacing)) {
    throw InvalidArgument(fmt::format("tagSpacing is {}, expected a positive ratio of gap to tag size", tag_spacing));
  }
  checkTagId(first_id, ids);
  checkTagId(first_id + cols * rows - 1, ids);
  if (border_bits < 0 || border_bits > 2) throw InvalidArgument(fmt::format("borderBits is {}, expected 1 or 2", border_bits));
  if (border_bits == 2 && !mayHaveWideBorder(family)) {
    throw InvalidArgument(fmt::format("borderBits is 2, which only tags of tag36h11, tag36h10, tag25h9 and tag16h5 have, not {}", family));
  }
  Target target;
  target.type = TargetType::kAprilGrid;
  target.family = family;
  target.cols = cols;
  target.rows = rows;
  target.tag_spacing = tag_spacing;
  target.first_id = first_id;
  target.border_bits = border_bits;
  const double pitch = tag_size * (1.0 + tag_spacing);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      TargetTag tag;
      tag.id = first_id + row * cols + col;
      tag.size = tag_size;
      tag.T_target_tag.translation() = Eigen::Vector3d(tag_size / 2.0 + col * pitch, tag_size / 2.0 + row * pitch, 0.0);
      // The grid's y points up and its z out of the board; the tag's own y points down and its z into the tag.
      tag.T_target_tag.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
      target.tags.push_back(tag);
    }
  }
  addTagCorners(target);
  return target;
}

Target pointsTarget(const std::vector<TargetPoint>& points) {
  if (points.empty()) throw InvalidArgument("a target without points, expected one or more");
  Target target;
  target.type = TargetType::kPoints;
  target.points = points;
  for (TargetPoint& point : target.points) point.id.corner = 0;
  sortPoints(target);
  return target;
}

}  // namespace poecal
