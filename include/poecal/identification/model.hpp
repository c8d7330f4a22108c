// model.yaml: the calibrated cell, with the standard deviation of each figure.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/compensation/compensate.hpp"
#include "poecal/effects/effect.hpp"
#include "poecal/identification/driver_ranges.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// Standard deviations of a model; empty or unset where a figure was not estimated.
struct ModelDeviation {
  std::vector<Vector6d> twists;  ///< of each joint's xi
  std::optional<Vector6d> gamma;
  std::optional<Vector6d> T_camera_near;  ///< left perturbation (w; v) in camera
  std::optional<Vector6d> T_far_target;   ///< left perturbation (w; v) in the far frame
};

/// What `identify` found and `predict`, `export` and `diagnose` start from.
struct Model {
  Cell cell;  ///< its arm calibrated, its camera with standard deviations; no camera for models from poses
  std::optional<Target> target;
  ModelDeviation deviation;
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  ///< in base [m/s^2]
  std::vector<AppliedEffect> effects;           ///< found by a diagnosis; what it stands beside is `cell`
  DriverRanges driver_ranges;                   ///< over the capture that these were found in
  std::string method;                           ///< "gao", "weighted", "bundle"
  std::string urdf, base_link, tip_link;        ///< where the arm came from a URDF
};

/// The arm of a model as it really moves. @throws InvalidArgument where the model has no arm.
RealArm realArm(const Model& model);

/// Text of model.yaml (format poecal-model/1).
std::string modelYaml(const Model& model);
/// @throws FileError as the readers of the parts do.
Model readModel(const std::filesystem::path& file);

}  // namespace poecal
