// robot.yaml and URDF: the arm in, the corrected arm out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/robot/arm.hpp"

namespace poecal {

/// Reads robot.yaml (format poecal-robot/1).
/// @throws FileError with the line: unknown or missing keys, axis not of unit length (1e-6; within it is normalised), a revolute joint
/// without point, limits that are not lower < upper, no joints, links not one per joint, a point further than 50 m from the base.
Arm readRobotYaml(const std::filesystem::path& file);
/// Text of robot.yaml; reads back with the same bits in every figure but gamma, which passes through the flange's pose (1e-15).
std::string robotYaml(const Arm& arm);

/// Reads the chain base_link .. tip_link of a URDF: fixed joints are folded in, continuous joints are revolute ones without limits,
/// inertials become links. The mass of a body behind fixed joints, or on a side branch such as a gripper finger (at zero), counts for the
/// joint that carries it; without any inertial there are no links. A joint whose limits name no range has none.
/// @throws FileError: unreadable URDF, a link that is not there (the message lists those that are), a tip that does not lie below the base,
/// a mimic, floating or planar joint inside the chain, no moving joint, links that form no tree, a joint further than 50 m from the base;
/// a xacro, with the command that expands it.
Arm readUrdf(const std::filesystem::path& file, const std::string& base_link, const std::string& tip_link);

/// The links at which the chains of a URDF begin and end.
struct UrdfEnds {
  std::string root;
  /// Links that carry no joint, by name.
  std::vector<std::string> leaves;
};

/// Whether a URDF has a link of this name. @throws FileError: unreadable URDF.
bool hasLink(const std::filesystem::path& file, const std::string& link);

/// @throws FileError: unreadable URDF.
UrdfEnds urdfEnds(const std::filesystem::path& file);

/// Whether a robot's file is a URDF: by its ending, or because it begins as XML does. @throws FileError where it cannot be read.
bool isUrdf(const std::filesystem::path& file);

/// Reads robot.yaml or a URDF (isUrdf()), whose links must then be named. @throws FileError as the two readers; InvalidArgument where
/// links are missing.
Arm readArm(const std::filesystem::path& file, const std::string& base_link, const std::string& tip_link);

/// Text of the URDF with the chain's joint origins (and, where it cannot be avoided, axes) changed so that its forward kinematics is that
/// of `arm`; everything else in the file (comments, meshes, transmissions) stays. Joints are matched by order along the chain.
/// Where the tip link hangs directly on the last moving joint and its frame must leave the joint's axis, a link and a fixed joint are added
/// between.
/// @throws FileError as readUrdf, or if the chain has other joints than `arm`.
std::string correctedUrdf(const std::filesystem::path& urdf, const std::string& base_link, const std::string& tip_link, const Arm& arm);

}  // namespace poecal
