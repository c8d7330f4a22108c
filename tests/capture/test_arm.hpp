// A small arm with limits, and errors as text.
#pragma once

#include <string>

#include "poecal/core/error.hpp"
#include "poecal/robot/arm.hpp"

namespace poecal::test {

/// Two revolute joints and a prismatic one, all with limits but perhaps not where `limited` is false.
inline Arm smallArm(bool limited = true) {
  Arm arm;
  arm.joints = {Joint::revolute("joint_1", {0, 0, 1}, {0, 0, 0}), Joint::revolute("joint_2", {0, 1, 0}, {0, 0, 0.4}),
                Joint::prismatic("slide", {1, 0, 0})};
  if (limited) {
    arm.joints[0].limits = JointLimits{-2.0, 2.0};
    arm.joints[1].limits = JointLimits{-1.78, 1.78};
    arm.joints[2].limits = JointLimits{0.0, 0.2};
  }
  return arm;
}

/// what() of the poecal error that `call` throws, or a text that no test expects.
template <typename Expected, typename Call>
std::string messageOf(const Call& call) {
  try {
    call();
  } catch (const Expected& error) {
    return error.what();
  } catch (const Error& error) {
    return std::string("another kind of error: ") + error.what();
  }
  return "no error";
}

}  // namespace poecal::test
