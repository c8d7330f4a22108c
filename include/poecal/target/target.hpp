// What is looked at: tags and boards as named points in the target frame.
#pragma once

#include <compare>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace poecal {

enum class TargetType { kAprilTag, kPoints, kAprilGrid, kCharuco, kChessboard };

/// Name of a point as in detections.csv: tag id and corner 0..3; boards have tag -1 and the board's corner index.
struct PointId {
  int tag = 0;
  int corner = 0;
  auto operator<=>(const PointId&) const = default;
};

struct TargetPoint {
  PointId id;
  Eigen::Vector3d p_target = Eigen::Vector3d::Zero();  ///< [m]
};

/// A tag in the target. Its own frame: origin in its centre, x right, y down, z into the tag.
struct TargetTag {
  int id = 0;
  double size = 0.0;  ///< edge between the corners [m]
  Eigen::Isometry3d T_target_tag = Eigen::Isometry3d::Identity();
};

struct Target {
  TargetType type = TargetType::kAprilTag;
  std::string family;               ///< apriltag and aprilgrid
  std::vector<TargetTag> tags;      ///< apriltag, and aprilgrid written out
  int cols = 0, rows = 0;           ///< charuco: squares; chessboard: inner corners; aprilgrid: tags
  double square = 0.0;              ///< charuco, chessboard [m]
  double marker = 0.0;              ///< charuco [m]
  std::string dictionary;           ///< charuco, OpenCV's name
  double tag_spacing = 0.0;         ///< aprilgrid: gap between tags / tag size
  int first_id = 0;                 ///< aprilgrid
  int border_bits = 0;              ///< aprilgrid: width of the tags' black border [cells]; 0: not stated, found from each picture
  std::vector<TargetPoint> points;  ///< every named point, sorted by id

  /// The point, or nullptr where the target has none of that name.
  const TargetPoint* find(PointId id) const;
  /// AprilTags, alone or as a grid: their corners are where edges meet, and their ids are known.
  bool hasTags() const { return type == TargetType::kAprilTag || type == TargetType::kAprilGrid; }
  /// All points in one plane to 1e-9 m.
  bool planar() const;
};

/// Corners of a tag in its own frame, in AprilTag 3's order: (-s/2, s/2), (s/2, s/2), (s/2, -s/2), (-s/2, -s/2).
Eigen::Matrix<double, 3, 4> tagCorners(double size);

/// An apriltag target from its tags. @throws InvalidArgument for repeated ids or sizes that are not positive.
Target apriltagTarget(const std::string& family, const std::vector<TargetTag>& tags);
Target chessboardTarget(int cols, int rows, double square);
/// Corner (col, row) at ((col + 1) square, (row + 1) square, 0): OpenCV 4.6's CharucoBoard::create.
Target charucoTarget(int cols, int rows, double square, double marker, const std::string& dictionary);
/// Kalibr's grid: tag first_id at the origin with its corner 0, ids grow along x, then along y (up); z out of the board.
/// The tags' corners are those of their black border, which is border_bits cells wide: 1 as AprilTag draws it, 2 as Kalibr does, 0 for
/// whichever a picture shows. @throws InvalidArgument as well for two cells of a family that nobody draws so.
Target aprilgridTarget(const std::string& family, int cols, int rows, double tag_size, double tag_spacing, int first_id,
                       int border_bits = 0);
/// Single points from another detector; tag = id, corner 0.
Target pointsTarget(const std::vector<TargetPoint>& points);

/// Reads target.yaml, or Kalibr's form of it (`target_type`: aprilgrid or checkerboard).
/// @throws FileError with the line: unknown type or keys, a checkerboard whose cells are not square, a size that is missing or not
/// positive, repeated ids.
Target readTarget(const std::filesystem::path& file);
std::string targetYaml(const Target& target);

}  // namespace poecal
