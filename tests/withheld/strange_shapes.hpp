// What both families of unlisted flaws are made with.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "withheld/cell.hpp"

namespace withheld {

/// An error of joint k (from 0) of the size value[0] and of any shape in [-1, 1].
Flaw jointFlaw(const std::string& effect, std::size_t k, const std::string& driver, std::function<double(const Shot&, const Loads&)> shape,
               bool yields);

/// Joints that do not slide.
std::vector<std::size_t> turningJoints(const Cell& cell);

/// Joints whose torque changes enough over the shots to drive anything.
std::vector<std::size_t> loadedJoints(const Cell& cell, const std::vector<Shot>& shots);

/// A mount that moves to and fro with wave(share of the capture's time) in [-1, 1]: the camera's, or the target's.
Flaw mountFlaw(const std::string& effect, bool camera, const std::vector<Shot>& shots, std::function<double(double)> wave, Chance& chance);

/// A flaw of the second family; see strangeFlaw.
Flaw secondStrangeFlaw(const Cell& cell, const std::vector<Shot>& shots, Chance& chance);

}  // namespace withheld
