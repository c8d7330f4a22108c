// Where a board is held for intrinsics pictures.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// Poses T_camera_target of a board whole in the picture: 35 to 90 % of the picture's height in size, tilted by up to 35 degrees about both
/// of its sides and rolled by up to 20, its centre anywhere that this leaves.
/// @throws InsufficientData where 1000 draws for a pose find none.
std::vector<Eigen::Isometry3d> drawBoardPoses(const Camera& camera, const Target& board, int count, std::uint64_t seed);

}  // namespace poecal
