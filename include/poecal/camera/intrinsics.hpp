// Intrinsics from pictures of a board: least squares over camera and board poses, with covariance and the bad pictures by name.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// The points of a board found in one picture.
struct BoardView {
  std::string image;
  Eigen::Matrix3Xd points;                     ///< p_target [m]
  Eigen::Matrix2Xd pixels;                     ///< [px], same columns
  Eigen::VectorXd sigmas = Eigen::VectorXd();  ///< [px] per axis, what the detector states of each; empty: not known, all alike
};

struct IntrinsicsOptions {
  DistortionModel model = DistortionModel::kPlumbBob;
  int max_iterations = 100;  ///< of each stage of the fit
  /// Corners that do not belong lose their weight, and pictures of such corners are left out; false: plain least squares over every corner
  /// of every picture, as cv::calibrateCamera, and bad pictures are only named.
  bool robust = true;
  /// A picture is named bad where its level (ViewResidual) exceeds this many robust standard deviations of the pictures' levels above their
  /// median, and left out where its typical corners exceed those of the others likewise...
  double bad_view_sigmas = 5.0;
  /// ...and this factor of the median. Never more than a quarter of the pictures: the worst.
  double bad_view_factor = 2.0;
  ProgressFunction progress = {};  ///< told of every step; may be empty
  /// @throws InvalidArgument with the field's name and value.
  void validate() const;
};

/// What a camera's covariance means in the picture.
///
/// At the middle of each cell of a grid of 12 x 9 over the picture: the standard deviation, in its worst direction, of where the camera
/// sees a point far away, less what a turn of the camera takes back (the pose of the camera is found with this camera, and takes that on).
struct ProjectionUncertainty {
  double median_px = 0.0;
  double largest_px = 0.0;
};

/// A camera fitted to some pictures.
struct IntrinsicsFit {
  Camera camera;                  ///< with standard deviations; NaN for a parameter that the pictures leave open
  std::vector<std::string> held;  ///< coefficients held at 0, since any value would fit
  Eigen::MatrixXd covariance;     ///< of camera.parameters(), board poses marginalised; rows and columns of those held are 0
  ProjectionUncertainty uncertainty;
  double rms_px = 0.0;    ///< sqrt(sum w |r|^2 / sum w), w the corners' weights, over the pictures it was fitted to
  double sigma_px = 0.0;  ///< standard deviation of one coordinate: sqrt(sum w |r|^2 / (2 sum w - parameters - 6 pictures))
  int pictures = 0;
  int points = 0;
  int outliers = 0;  ///< points whose weight is less than a half
  bool converged = false;
};

/// A picture's residuals under the chosen camera, its pose fitted again in the same way.
struct ViewResidual {
  std::string image;
  int points = 0;
  bool used = false;        ///< false where there are fewer than 4 points, or all on a line: nothing below is set then
  bool bad = false;         ///< its level is far beyond the others'
  bool left_out = false;    ///< bad, and not by some of its corners only: no part of IntrinsicsResult::robust
  int outliers = 0;         ///< points whose weight is less than a half
  double rms_px = 0.0;      ///< sqrt(sum |r|^2 / N), N points
  double level_px = 0.0;    ///< rms of the 95 % of its corners that fit best: what a picture is judged by
  double typical_px = 0.0;  ///< rms of normal noise whose median of |r| is the picture's: what half of its corners say
  double max_px = 0.0;
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
};

struct IntrinsicsResult {
  /// Plain least squares over all usable pictures, every corner counting the same: covariance (sigma_px^2 + (0.005 px)^2) times
  /// the inverse information. The second is what corners may be off by alike in all pictures, which no residual shows.
  IntrinsicsFit all;
  /// Without the pictures left out, each corner weighted by its residual (Hampel's function: 1 up to 3 standard deviations, 0 from 6 on,
  /// these by the median corner) and, where all pictures state sigmas, by 1 / (sigma^2 + floor^2): floor is what all corners have beside
  /// them, such that the median corner is as far off as said. These weights are 1 in the mean. Its covariance is larger where whole
  /// pictures pull at the camera more than noise in their corners would let them: boards that are not flat, a lens beyond its model.
  IntrinsicsFit robust;
  bool is_robust = true;              ///< as the options said
  std::vector<ViewResidual> views;    ///< one for each picture given, in their order
  std::vector<std::string> warnings;  ///< bad pictures, coefficients that the pictures do not determine, too little tilt

  /// The fit that was asked for.
  const IntrinsicsFit& chosen() const { return is_robust ? robust : all; }
};

/// Fits a camera and one board pose per picture:
///
///   minimise sum_v sum_i w_vi |project(camera, T_camera_target_v p_i) - px_vi|^2
///
/// The start is a scan over focal lengths with poses from OpenCV's solvePnP; the fit is Levenberg-Marquardt with analytic Jacobians,
/// the poses eliminated by the Schur complement. Boards may be flat or not. A coefficient whose deviation is beyond what a lens may have is
/// held at 0, unless the pictures tell it from 0. The result does not depend on the machine or on threads.
/// @throws InvalidArgument: views whose points, pixels and sigmas differ in number or are not finite, a size that is not positive, options
/// out of range.
/// @throws InsufficientData: fewer than 3 usable pictures, fewer numbers than unknowns, or a focal length or principal point that the
/// pictures leave open (all boards parallel to the image plane).
/// @throws ImplausibleInput: more than a quarter of the pictures have another focal length than the others.
IntrinsicsResult calibrateIntrinsics(const std::vector<BoardView>& views, int width, int height, const IntrinsicsOptions& options);

}  // namespace poecal
