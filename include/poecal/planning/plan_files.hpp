// What a plan starts from, as files: a capture with its results, or an arm, a camera and a target before the first picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "poecal/calibration/load_capture.hpp"
#include "poecal/planning/plan.hpp"

namespace poecal {

/// A capture, and the model that was found from it. Corners are the capture's, or detections.csv beside the model; the noise, the arm's
/// tolerance and what is open are those of diagnosis.json or identification.json beside the model, where they are.
struct PlanSource {
  CaptureSource capture;
  std::filesystem::path model;
};

/// @throws FileError as the readers of the files; where a file that is needed is not there, or the model has no camera or is one of another
/// cell: requireModelOf().
PlanningCell readPlanningCell(const PlanSource& source);

/// Before the first picture: what stands where, roughly.
struct FirstCapture {
  std::filesystem::path robot, camera, target;
  std::string base_link = {}, tip_link = {};  ///< where the robot is a URDF
  Setup setup = Setup::kEyeToHand;
  std::filesystem::path registration = {};                  ///< a registration.yaml instead of the four below
  std::optional<Eigen::Vector3d> camera_at;                 ///< in base (in hand: in flange) [m]
  std::optional<Eigen::Vector3d> look_at;                   ///< a point that the camera looks at, likewise
  Eigen::Vector3d target_at = Eigen::Vector3d::Zero();      ///< its centre in flange (in hand: in base) [m]
  Eigen::Vector3d target_faces = Eigen::Vector3d::UnitZ();  ///< direction from which its front is seen, likewise
  double rough_position = 0.05;                             ///< 1 sigma of the places [m]
  double corner_sigma = 0.1;                                ///< noise to expect of a corner's u and v [px]
  double rough_rotation = 0.1;                              ///< 1 sigma of the turns [rad]
};

/// @throws FileError as the readers of the files; InvalidArgument: neither a registration nor a camera's place, directions without length.
PlanningCell firstCapture(const FirstCapture& first);

}  // namespace poecal
