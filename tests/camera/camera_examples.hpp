// Cameras that the tests share: lenses as they occur, one per model of the table.
#pragma once

#include <vector>

#include "poecal/camera/camera.hpp"

namespace poecal::test {

inline Camera makeCamera(DistortionModel model, std::vector<double> distortion) {
  Camera camera;
  camera.model = model;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 536.0;
  camera.fy = 541.5;
  camera.cx = 325.25;
  camera.cy = 236.5;
  camera.distortion = Eigen::Map<Eigen::VectorXd>(distortion.data(), static_cast<Eigen::Index>(distortion.size()));
  return camera;
}

/// A webcam's barrel with tangential terms (the lens of OpenCV's left01.jpg).
inline Camera plumbBobCamera() { return makeCamera(DistortionModel::kPlumbBob, {-0.265, -0.047, 0.0018, -0.0003, 0.252}); }
/// An Azure-Kinect-like lens, numerator and denominator nearly alike.
inline Camera rationalCamera() {
  return makeCamera(DistortionModel::kRationalPolynomial, {0.52, -2.7, 0.0006, -0.0002, 1.6, 0.4, -2.5, 1.5});
}
/// A fisheye whose picture goes beyond 90 degrees from the axis.
inline Camera equidistantCamera() {
  Camera camera = makeCamera(DistortionModel::kEquidistant, {-0.013, 0.021, -0.012, 0.0021});
  camera.fx = 190.0;
  camera.fy = 191.0;
  return camera;
}

/// A rational lens whose elements are tilted against each other.
inline Camera thinPrismCamera() {
  return makeCamera(DistortionModel::kThinPrism, {0.52, -2.7, 0.0006, -0.0002, 1.6, 0.4, -2.5, 1.5, 0.004, -0.002, -0.003, 0.0015});
}

inline std::vector<Camera> exampleCameras() { return {plumbBobCamera(), rationalCamera(), equidistantCamera(), thinPrismCamera()}; }

}  // namespace poecal::test
