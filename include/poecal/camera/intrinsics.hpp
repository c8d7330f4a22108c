// Intrinsics from pictures of a board: OpenCV for the start, then our own refinement with covariance and named bad pictures.
#pragma once

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
  int max_iterations = 100;
  /// A picture is named bad where its rms exceeds this many robust standard deviations of the pictures' rms above their median...
  double bad_view_sigmas = 5.0;
  /// ...and this factor of the median.
  double bad_view_factor = 2.0;
  void validate() const;
};

struct ViewResidual {
  std::string image;
  int points = 0;
  double rms_px = 0.0;  ///< sqrt(sum |r|^2 / N), N points, with the camera fitted to all pictures
  double max_px = 0.0;
  bool bad = false;  ///< left out of `camera`
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
};

struct IntrinsicsResult {
  Camera camera;               ///< with standard deviations, fitted without the bad pictures
  Camera camera_all;           ///< fitted with all pictures
  double rms_px = 0.0;         ///< of `camera` on the pictures it was fitted to
  double rms_all_px = 0.0;     ///< of `camera_all` on all pictures
  double sigma_px = 0.0;       ///< estimated standard deviation of one coordinate: sqrt(sum r^2 / (2N - parameters))
  Eigen::MatrixXd covariance;  ///< of camera.parameters()
  std::vector<ViewResidual> views;
  std::vector<std::string> warnings;  ///< e.g. coefficients that the pictures do not determine
};

/// @throws InsufficientData: fewer than 3 usable pictures, fewer than 4 points in all of them, or all boards parallel to the image plane.
IntrinsicsResult calibrateIntrinsics(const std::vector<BoardView>& views, int width, int height, const IntrinsicsOptions& options);

}  // namespace poecal
