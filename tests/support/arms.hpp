// Arms for tests, in general position so that nothing is zero by luck.
#pragma once

#include <string>

#include "poecal/robot/arm.hpp"
#include "support/random.hpp"

namespace poecal::test {

/// An arm of one joint per letter, R revolute or P prismatic ("RRPR"), with random axes and points within `reach` [m] of the base.
inline Arm randomArm(Rng& rng, const std::string& joint_types, double reach = 0.5) {
  Arm arm;
  arm.name = joint_types;
  for (const char type : joint_types) {
    const std::string name = "joint_" + std::to_string(arm.jointCount() + 1);
    const Eigen::Vector3d axis = uniformVector(rng, 3, 1.0);
    const Eigen::Vector3d point = uniformVector(rng, 3, reach);
    arm.joints.push_back(type == 'R' ? Joint::revolute(name, axis, point) : Joint::prismatic(name, axis, point));
  }
  arm.gamma << uniformVector(rng, 3, 1.0), uniformVector(rng, 3, reach);
  return arm;
}

}  // namespace poecal::test
