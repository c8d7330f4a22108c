// A calibrated cell as ROS takes it, and the joints as a table.
#pragma once

#include <string>

#include "poecal/identification/model.hpp"

namespace poecal {

/// A camera_info file of ROS's camera_calibration, without poecal's own keys.
/// @throws InvalidArgument where the model has no camera, or a lens model that ROS does not have (thin_prism).
std::string cameraInfoYaml(const Model& model);

/// Names of the frames in what is written.
struct FrameNames {
  std::string base = "base", flange = "flange", camera = "camera", target = "target";
};
/// "base" and "flange", or the links of the model's URDF.
FrameNames frameNames(const Model& model);

/// The two fixed transforms of the cell both ways, each as a geometry_msgs/TransformStamped, and as command lines of tf2's
/// static_transform_publisher in comments. tf2 takes one way of each: frames form a tree.
///   camera fixed: base -> camera, flange -> target;  camera on the flange: flange -> camera, base -> target.
/// @throws InvalidArgument where the model has no camera.
std::string transformsYaml(const Model& model, const FrameNames& names);

/// A row per joint: its axis before and after, how far it tilted and shifted, its zero, and what it does beyond geometry.
/// @throws InvalidArgument where the model is none of the nominal arm: differenceOfArms().
std::string jointTableCsv(const Model& model, const Arm& nominal);

}  // namespace poecal
