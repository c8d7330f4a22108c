// The capture folder: manifest, samples and the files they name, read strictly and checked.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/robot/arm.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// Where the camera sits: fixed with the target on the flange, or on the flange with the target fixed.
enum class Setup { kEyeToHand, kEyeInHand };
const char* setupName(Setup setup);  ///< "eye_to_hand", "eye_in_hand"

/// One row of samples.csv or poses.csv. Vectors are empty and optionals unset where the file has no such column.
struct Sample {
  std::string image;                               ///< imageName() of what the file has; empty for poses.csv
  int line = 0;                                    ///< 1-based line in its file
  Eigen::VectorXd q;                               ///< joint readings [rad] or [m]
  std::optional<Eigen::Isometry3d> T_base_flange;  ///< as the controller reports it
  std::optional<long> pose;
  std::optional<double> stamp, temperature, payload;
  Eigen::VectorXd dir, dq;
  std::vector<double> other;  ///< values of SampleTable::other_columns; NaN where a cell is not a number
};

struct SampleTable {
  std::filesystem::path file;
  std::vector<Sample> samples;  ///< in the order of the file
  std::vector<std::string> other_columns;
  bool has_joints = false;
  bool has_flange_poses = false;
};

/// capture.yaml with everything it names but the pictures.
struct Capture {
  std::filesystem::path folder;
  std::vector<std::filesystem::path> files;  ///< that were read: the manifest and what it names, but neither detections nor pictures
  std::string name;
  Setup setup = Setup::kEyeToHand;
  std::optional<Arm> arm;
  std::filesystem::path robot_file;  ///< robot.yaml or URDF; empty where none is named
  std::string base_link, tip_link;   ///< URDF only
  std::optional<Camera> camera;      ///< unset where intrinsics: names a folder instead; 0 x 0 where its file is K and D alone
  std::filesystem::path intrinsics_folder;
  Target target;
  std::optional<Target> reference;
  std::filesystem::path detections_file;    ///< empty where none is named
  std::filesystem::path registration_file;  ///< known transforms; empty where none are named
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};
  SampleTable table;
};

/// Reads a capture folder and checks what can be checked without pictures.
///
/// @throws FileError (with file and line): unknown or missing keys; a file that is not there; a joint column missing, a cell that is not a
/// number; an image in two rows; readings beyond the joint limits by more than 5 % of the range (where degrees or millimetres would
/// explain them, that is said); dir other than -1, 0, 1; a quaternion whose length is not 1 to 1e-3; neither joints nor flange poses;
/// joints without a robot; a reference that shares names of points with the target.
/// @throws InsufficientData: no rows; two or more rows that all have one pose. A joint that never moved is not an error here.
Capture readCapture(const std::filesystem::path& folder);

/// Reads samples.csv. Errors as readCapture.
/// @param joint_count  0 where no arm is known (q columns are then counted).
/// @param limits_of    arm for the plausibility checks of the readings, or nullptr.
SampleTable readSamples(const std::filesystem::path& file, int joint_count, const Arm* limits_of);
/// Text of samples.csv; columns that no sample has are left out, and cells that a sample lacks are empty.
std::string samplesCsv(const SampleTable& table);

/// Reads a table of joint readings (q1..qn, and image where pictures are meant) for an arm; its other columns as samples.csv has them.
std::vector<Sample> readJoints(const std::filesystem::path& file, const Arm& arm);
/// The same with the names of its other columns.
SampleTable readJointTable(const std::filesystem::path& file, const Arm& arm);

/// Reads a table of poses that the flange should go to: x, y, z, qx, qy, qz, qw as Sample::T_base_flange; joints from which a search
/// begins, and other columns, as samples.csv has them. Errors as readCapture.
SampleTable readWantedPoses(const std::filesystem::path& file, const Arm& arm);

/// One row of poses.csv: a measured pose, or a position alone.
struct MeasuredPose {
  Sample sample;                                                        ///< its joints and optional columns
  Eigen::Isometry3d T_instrument_tool = Eigen::Isometry3d::Identity();  ///< rotation is identity where `position_only`
  bool position_only = false;
  std::optional<double> sigma_position, sigma_rotation;  ///< [m], [rad]
};

struct PoseTable {
  std::filesystem::path file;
  std::vector<MeasuredPose> poses;
  std::vector<std::string> other_columns;
  bool position_only = false;
};

/// Reads poses.csv for an arm. Errors as readCapture.
PoseTable readPoses(const std::filesystem::path& file, const Arm& arm);

/// The groups of rows that share a pose (column `pose`; a row without one is its own), in order of first appearance: indices into
/// `samples`.
std::vector<std::vector<std::size_t>> poseGroups(const std::vector<Sample>& samples);

}  // namespace poecal
