// All that was measured of a cell, wherever it came from: a capture folder, a table of poses, or memory.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// Samples with what was seen or measured at each. Observations are either all corners or all poses.
struct Measurements {
  Setup setup = Setup::kEyeToHand;
  Target target;                           ///< what the corners are of; no points where an instrument measured poses
  std::vector<Sample> samples;             ///< in the order taken
  std::vector<std::string> other_columns;  ///< names of the samples' further columns, which may drive an effect
  std::vector<Observation> observations;   ///< each names its sample
  /// Whether the observations came with their standard deviations. Without them all corners count alike and their noise is estimated, as
  /// are the position and rotation noise of poses.
  bool sigmas_stated = false;
  /// Indices of observations that show one pose of the arm and are held out together. Empty: see poseGroups().
  std::vector<std::vector<std::size_t>> groups;
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  ///< in base [m/s^2]

  /// Adds a picture: a sample (at least its joint readings q) and the corners seen in it [px]. A corner whose sigma is a number states its
  /// deviation. A picture without corners adds a sample alone. @throws InvalidArgument for a corner that the target does not have.
  void addPicture(const Sample& sample, const std::vector<Corner>& corners);
  /// Adds a pose that an instrument measured. Deviations are per axis [m] and [rad]; unset where none are stated.
  void addPose(const Sample& sample, const Eigen::Isometry3d& T_instrument_tool, std::optional<double> sigma_position = std::nullopt,
               std::optional<double> sigma_rotation = std::nullopt);

  /// Adds a position of the tool that an instrument measured, its deviation per axis [m].
  void addPosition(const Sample& sample, const Eigen::Vector3d& p_instrument, std::optional<double> sigma_position = std::nullopt);

  /// Adds a picture for each row of a table. @param px  of each picture m x 2, the pixels of target.points in their order; NaN for a point
  /// that is not seen. @param sigma  of every corner, per axis [px]; unset where none is stated.
  /// @throws InvalidArgument: another number of pictures than rows or of corners than points, a corner that is NaN in one axis alone, a
  /// table with other further columns than those added before.
  void addPictures(const SampleTable& table, const std::vector<Eigen::MatrixX2d>& px, std::optional<double> sigma = std::nullopt);
  /// Adds a pose, or a position (N x 3), for each row of a table, as addPose() and addPosition() do.
  /// @throws InvalidArgument: another number of them than rows, a position that is not finite, a table with other further columns.
  void addPoses(const SampleTable& table, const std::vector<Eigen::Isometry3d>& T_instrument_tool,
                std::optional<double> sigma_position = std::nullopt, std::optional<double> sigma_rotation = std::nullopt);
  void addPositions(const SampleTable& table, const Eigen::MatrixX3d& p_instrument, std::optional<double> sigma_position = std::nullopt);

  /// `groups`, or where that is empty the observations grouped as poseGroups() groups their samples.
  std::vector<std::vector<std::size_t>> poseGroups() const;

  /// Adds a row of a table of poses.
  void addMeasured(const MeasuredPose& measured);

 private:
  void beginRows(const SampleTable& table, const char* what, std::size_t count);
};

/// The corners of a capture. Pictures without corners of the target give no observation.
Measurements measurementsOf(const Capture& capture, const Detections& detections);
/// The poses of an instrument.
Measurements measurementsOf(const PoseTable& table);

}  // namespace poecal
