// Hand-eye and base registration from corners, and the flange poses that the camera measured.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "poecal/cell/adjustment.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

struct RegistrationOptions {
  int hypotheses = 400;  ///< random minimal sets tried
  bool robust = true;
  /// Pictures that the rest contradicts are named and left out: only where the arm's poses are the controller's own, since a nominal arm is
  /// wrong everywhere by more than a picture is.
  bool leave_out_bad = true;
  ProgressFunction progress = {};  ///< may be empty
};

/// One sample after registration.
struct RegisteredSample {
  std::size_t sample = 0;
  double rms_px = 0.0;       ///< of its corners in the registered cell
  double free_rms_px = 0.0;  ///< of its corners with a pose of its own: the floor
  bool left_out = false;     ///< weight 0 for most of its corners, or named as bad
  bool has_pose = false;     ///< T_base_flange was measured (at least 4 corners not on a line)
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_base_flange = Eigen::Isometry3d::Identity();  ///< measured
  /// Of (log of the left rotation error in base; position of the flange in base), [rad; m], from the corners alone, at
  /// `RegistrationResult::corner_scale`.
  Matrix6d covariance = Matrix6d::Zero();
};

struct RegistrationResult {
  Cell cell;                 ///< with the registration
  Registration closed_form;  ///< before any corner was fitted: what a hand-eye solver alone gives
  Adjustment adjustment;     ///< its covariance and unseen directions: T_camera_near (6), then T_far_target (6)
  std::vector<RegisteredSample> samples;
  double rms_px = 0.0;  ///< sqrt(sum |r|^2 / N) over the corners that were used
  double rms_all_px =
      0.0;  ///< over all corners that can be projected; where pictures were left out one by one, of the fit to every picture
  double free_rms_px = 0.0;  ///< with a pose for every picture: what the corners allow whatever the arm
  /// Noise of the corners in units of their stated sigma, from the free poses (2N - 6 numbers a picture); 1 where there is no redundancy.
  double corner_scale = 1.0;
  double corner_sigma_px = 0.0;  ///< the same per axis [px]: times the root mean square of the stated sigmas
  /// Direction in near along which the arm's motions leave both transforms open: the one axis of all turns.
  std::optional<Eigen::Vector3d> open_axis;
  std::array<bool, 3> open_near{};  ///< which coordinates of the camera in near are open for it
  std::vector<int> open;            ///< numbers of `adjustment` that are open for it: their deviation is infinite
  std::vector<std::string> warnings;
};

/// Registers a cell: poses of the target in closed form (both solutions of a planar one), T_camera_near and T_far_target by random
/// minimal sets scored on the corners of all pictures, then the robust reprojection error over both.
///
/// @param cell  camera, arm (or none) and setup; its registration is ignored.
/// What it leaves is judged by what the pictures leave with poses of their own and by what is left of random pairings of readings and
/// pictures; nearly half of the pictures may belong to other rows.
/// @throws InsufficientData: fewer than 3 pictures of different poses with 4 corners, or poses that do not turn the target.
/// @throws ImplausibleCapture: the registration is hardly better than chance, or a single mistake explains what it leaves (units, signs and
/// order of joints, quaternions, setup, order of rows, size of the target, lens): the message says which.
RegistrationResult registerCell(const Cell& cell, const std::vector<Observation>& observations, const RegistrationOptions& options);

struct PoseRegistration {
  Adjustment adjustment;
  std::vector<std::string> warnings;  ///< known transforms that the poses contradict
};

/// The same from poses of an instrument: T_camera_near = T_instrument_base, T_far_target = T_flange_tool.
/// @throws InsufficientData, ImplausibleCapture as registerCell.
PoseRegistration registerPoses(const Cell& cell, const std::vector<Observation>& observations, bool robust);

/// Fraction of the weight of an observation's units that a fit kept.
double keptShare(const std::vector<double>& unit_weights);

}  // namespace poecal
