// A real recording of an arm's poses: what was logged, and what the withheld world's own fit makes of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "withheld/leftover.hpp"

namespace withheld {

struct Recording {
  Cell cell;                 ///< arm as robot.yaml has it, without masses; the camera is the instrument, the target the tool
  std::vector<Shot> shots;   ///< joints as logged
  std::vector<Frame> poses;  ///< T_camera_target as measured
  /// Lines of poses.csv: its head without the joints, and what stands after them in every row.
  std::string head;
  std::vector<std::string> rests;
};

/// Reads robot.yaml and poses.csv (q1.. first) of a folder.
/// @throws std::runtime_error, YAML::Exception
Recording readRecording(const std::filesystem::path& folder);

/// 1 sigma of each axis.
struct PoseNoise {
  double rotation = 1e-3;  ///< [rad]
  double position = 1e-3;  ///< [m]
};

/// Six numbers a shot: turn and shift from a measured pose to that of a cell's target, both in the measured one.
Observe observePoses(const std::vector<Frame>& poses);
/// As noiseFactors, for poses.
std::vector<Eigen::MatrixXd> poseFactors(std::size_t shots, const PoseNoise& noise);

/// Brings the cell to the poses by least squares: where instrument and tool are (Shah 2013), then the frame of every joint too, leaving out
/// what is more than four sigma away.
///
/// @return what the poses still scatter by, from medians, so that single bad rows do not count
PoseNoise fit(Recording& recording);

}  // namespace withheld
