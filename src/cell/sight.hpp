// What a camera sees of a target: how squarely, how large, and whether in the picture.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// One tag of a target, or a whole board, as a camera sees it.
struct FaceSight {
  std::vector<Corner>
      corners;              ///< exact pixels, sorted by id; fewer than the face has where a point is behind the camera or beyond its lens
  bool complete = false;    ///< every corner has a pixel
  double facing_cos = 1.0;  ///< cosine between the face's normal and the line of sight at its centre; negative from behind
  double shortest_side_px = 0.0;  ///< of a tag's outline, or of a board's squares

  /// Facing within 80 degrees: beyond that no detector reads a tag, whatever its size.
  bool readable() const;
};

/// A face for each tag of an apriltag target or an aprilgrid; one for a charuco board or a chessboard. Single points are one face
/// each that is always seen squarely, with an endless side.
std::vector<FaceSight> sightOf(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target);

/// All corners in the picture, `margin` of its width and height away from its borders. An empty list is not.
bool inPicture(const Camera& camera, const std::vector<Corner>& corners, double margin);

}  // namespace poecal
