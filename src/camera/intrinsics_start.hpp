// A first guess of the camera and of board poses, good enough for least squares to find the rest.
#pragma once

#include <optional>
#include <vector>

#include "camera/board_bundle.hpp"

namespace poecal {

/// Whether a picture can carry a pose: at least 4 points, not all on a line.
bool usable(const BoardView& view);

/// Pose of the board for a known camera: solvePnP on the rays, both solutions of a flat board refined, the better one. Nothing where
/// fewer than 4 of the pixels have a ray in front of the camera, or no solution sees all points.
std::optional<Eigen::Isometry3d> boardPose(const Camera& camera, const BoardView& view);

/// A camera without distortion, its centre in the middle of the picture, one focal length for both axes: the one of a scan from a
/// fifth to eight times the picture's width that fits the boards best (median over pictures).
Camera startCamera(const std::vector<const BoardView*>& views, int width, int height, DistortionModel model);

/// Whether the points lie in a plane, to a thousandth of their extent.
bool flat(const Eigen::Matrix3Xd& points);

}  // namespace poecal
