// Intrinsics from pictures of a board: least squares over camera and board poses, with covariance and the bad pictures by name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"

namespace poecal {

/// The points of a board found in one picture.
struct BoardView {
  std::string image;
  Eigen::Matrix3Xd points;  ///< p_target [m]
  Eigen::Matrix2Xd pixels;  ///< [px], same columns
};

struct IntrinsicsOptions {
  DistortionModel model = DistortionModel::kPlumbBob;
  int max_iterations = 100;  ///< of each stage of the fit
  /// A picture is named bad where its rms exceeds this many robust standard deviations of the pictures' rms above their median...
  double bad_view_sigmas = 5.0;
  /// ...and this factor of the median. Never more than a quarter of the pictures: the worst.
  double bad_view_factor = 2.0;
  /// Whether chosen() is the fit without the bad pictures.
  bool drop_bad = false;
  /// @throws InvalidArgument with the field's name and value.
  void validate() const;
};

/// A camera fitted to some pictures by plain least squares: every corner counts the same, as in cv::calibrateCamera.
struct IntrinsicsFit {
  Camera camera;               ///< with standard deviations; NaN for a parameter that the pictures leave open
  Eigen::MatrixXd covariance;  ///< of camera.parameters(), board poses marginalised, scaled by sigma_px^2
  double rms_px = 0.0;         ///< sqrt(sum |r|^2 / N), N points, over the pictures it was fitted to
  double sigma_px = 0.0;       ///< standard deviation of one coordinate: sqrt(sum |r|^2 / (2 N - parameters - 6 pictures))
  int pictures = 0;
  int points = 0;
  bool converged = false;
};

/// A picture's residuals under the chosen camera, its pose fitted again.
struct ViewResidual {
  std::string image;
  int points = 0;
  bool used = false;    ///< false where there are fewer than 4 points, or all on a line: nothing below is set then
  bool bad = false;     ///< left out of IntrinsicsResult::without_bad
  double rms_px = 0.0;  ///< sqrt(sum |r|^2 / N), N points
  double max_px = 0.0;
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
};

struct IntrinsicsResult {
  IntrinsicsFit all;                         ///< to all usable pictures
  std::optional<IntrinsicsFit> without_bad;  ///< to the others, where some are bad
  bool drop_bad = false;                     ///< as the options said
  std::vector<ViewResidual> views;           ///< one for each picture given, in their order
  std::vector<std::string> warnings;         ///< bad pictures, coefficients that the pictures do not determine, too little tilt

  /// The fit that was asked for: `all`, or with drop_bad the one without the bad pictures (where there are any).
  const IntrinsicsFit& chosen() const { return drop_bad && without_bad ? *without_bad : all; }
};

/// Fits a camera and one board pose per picture:
///
///   minimise sum_v sum_i |project(camera, T_camera_target_v p_i) - px_vi|^2
///
/// The start is a scan over focal lengths with poses from OpenCV's solvePnP; the fit is Levenberg-Marquardt with analytic Jacobians,
/// the poses eliminated by the Schur complement. Boards may be flat or not. The result does not depend on the machine or on threads.
/// @throws InvalidArgument: views whose points and pixels differ in number, a size that is not positive, options out of range.
/// @throws InsufficientData: fewer than 3 usable pictures, fewer numbers than unknowns, or a focal length or principal point that the
/// pictures leave open (all boards parallel to the image plane).
IntrinsicsResult calibrateIntrinsics(const std::vector<BoardView>& views, int width, int height, const IntrinsicsOptions& options);

}  // namespace poecal
