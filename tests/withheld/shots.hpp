// Where the camera stands, what poses are taken, when and from which side.
#pragma once

#include <vector>

#include "withheld/cell.hpp"

namespace withheld {

/// Puts the camera 1.0 to 1.7 m before the tags, looking where many poses of the arm show them. Sets cell.T_camera_mount.
void placeCamera(Cell& cell, Chance& chance);
/// Puts the tags 0.6 to 1.2 m before a camera in hand, where enough poses of the arm show them. Sets cell.T_mount_target.
void placeTarget(Cell& cell, Chance& chance);

/// Whether all corners are in the picture, seen from their front and large enough to be read.
bool shows(const Cell& cell, const Eigen::VectorXd& q);

/// `count` poses that show the target, in random order; `times` shots of each.
/// @throws std::runtime_error where hardly any pose shows it.
std::vector<Shot> drawShots(const Cell& cell, std::size_t count, std::size_t times, bool moving, bool payloads, Chance& chance);

/// Directions of joints that move straight from the shot before.
void comeStraight(std::vector<Shot>& shots);

/// Further poses of the same capture, in the same hours (the first at its very beginning).
std::vector<Shot> drawUnseen(const Cell& cell, const std::vector<Shot>& seen, std::size_t count, Chance& chance);

}  // namespace withheld
