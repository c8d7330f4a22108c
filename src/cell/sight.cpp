#include "cell/sight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace poecal {
namespace {

/// Points of a face in the order of its sides: cols x rows, row by row.
struct FacePoints {
  std::vector<TargetPoint> points;
  int cols = 0, rows = 0;
  Eigen::Vector3d center_target = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_target = Eigen::Vector3d::Zero();  ///< towards whoever looks at the front
};

FacePoints tagPoints(const TargetTag& tag) {
  const Eigen::Matrix<double, 3, 4> corners = tagCorners(tag.size);
  FacePoints face{.points = {},
                  .cols = 2,
                  .rows = 2,
                  .center_target = tag.T_target_tag.translation(),
                  .normal_target = -tag.T_target_tag.linear().col(2)};
  // Corners 0, 1, 3, 2 are row by row.
  for (const int corner : {0, 1, 3, 2}) face.points.push_back({{tag.id, corner}, tag.T_target_tag * corners.col(corner)});
  return face;
}

FacePoints boardPoints(const Target& board, int cols, int rows) {
  FacePoints face{.points = board.points,
                  .cols = cols,
                  .rows = rows,
                  .center_target = Eigen::Vector3d::Zero(),
                  .normal_target = -Eigen::Vector3d::UnitZ()};
  face.center_target = 0.5 * (board.points.front().p_target + board.points.back().p_target);
  return face;
}

std::vector<FacePoints> facesOf(const Target& target) {
  std::vector<FacePoints> faces;
  switch (target.type) {
    case TargetType::kAprilTag:
    case TargetType::kAprilGrid:
      for (const TargetTag& tag : target.tags) faces.push_back(tagPoints(tag));
      break;
    case TargetType::kCharuco:
      faces.push_back(boardPoints(target, target.cols - 1, target.rows - 1));
      break;
    case TargetType::kChessboard:
      faces.push_back(boardPoints(target, target.cols, target.rows));
      break;
    case TargetType::kPoints:
      for (const TargetPoint& point : target.points) faces.push_back({.points = {point}, .cols = 1, .rows = 1});
      break;
  }
  return faces;
}

double shortestSide(const std::vector<Corner>& grid, int cols, int rows) {
  double shortest = std::numeric_limits<double>::infinity();
  const auto px = [&](int col, int row) { return grid[static_cast<std::size_t>(row * cols + col)].px; };
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      if (col + 1 < cols) shortest = std::min(shortest, (px(col + 1, row) - px(col, row)).norm());
      if (row + 1 < rows) shortest = std::min(shortest, (px(col, row + 1) - px(col, row)).norm());
    }
  }
  return shortest;
}

}  // namespace

std::vector<FaceSight> sightOf(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target) {
  std::vector<FaceSight> sights;
  for (const FacePoints& face : facesOf(target)) {
    FaceSight sight;
    for (const TargetPoint& point : face.points) {
      if (const auto px = project(camera, T_camera_target * point.p_target)) sight.corners.push_back({.id = point.id, .px = *px});
    }
    sight.complete = sight.corners.size() == face.points.size();
    if (sight.complete) sight.shortest_side_px = shortestSide(sight.corners, face.cols, face.rows);
    if (!face.normal_target.isZero()) {
      const Eigen::Vector3d center_camera = T_camera_target * face.center_target;
      sight.facing_cos = -center_camera.normalized().dot(T_camera_target.linear() * face.normal_target);
    }
    std::sort(sight.corners.begin(), sight.corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
    sights.push_back(std::move(sight));
  }
  return sights;
}

bool FaceSight::readable() const {
  static const double kGrazingCos = std::cos(std::numbers::pi * 80.0 / 180.0);
  return facing_cos >= kGrazingCos;
}

bool inPicture(const Camera& camera, const std::vector<Corner>& corners, double margin) {
  const Eigen::Vector2d size(camera.width, camera.height);
  const Eigen::AlignedBox2d picture((margin * size).array() - 0.5, ((1.0 - margin) * size).array() - 0.5);
  return !corners.empty() && std::all_of(corners.begin(), corners.end(), [&](const Corner& corner) { return picture.contains(corner.px); });
}

}  // namespace poecal
