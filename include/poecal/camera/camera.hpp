// The camera: pinhole with a distortion model, projection with derivatives, and its inverse.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace poecal {

/// Names as in camera.yaml: plumb_bob (k1 k2 p1 p2 k3), rational_polynomial (k1 k2 p1 p2 k3 k4 k5 k6), equidistant (k1 k2 k3 k4),
/// thin_prism (k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, OpenCV's model of 12 coefficients).
enum class DistortionModel { kPlumbBob, kRationalPolynomial, kEquidistant, kThinPrism };

/// Intrinsics. Pixels follow OpenCV: the centre of the top-left pixel is (0, 0).
struct Camera {
  std::string name = "camera";
  int width = 0;
  int height = 0;
  DistortionModel model = DistortionModel::kPlumbBob;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  Eigen::VectorXd distortion;                     ///< the model's coefficients in OpenCV's order; missing trailing ones are zero
  /// Empty, or one per parameter (as parameters()); NaN where the file states none.
  Eigen::VectorXd standard_deviation;
  /// What its file says and is not kept (a skew of a fraction of a pixel, keys that are not known), one sentence each.
  std::vector<std::string> remarks;

  /// Most parameters that a model has.
  static constexpr int kMaxParameters = 16;
  /// fx fy cx cy, then the distortion coefficients.
  Eigen::VectorXd parameters() const;
  /// @throws InvalidArgument unless there are parameterCount() values.
  void setParameters(const Eigen::VectorXd& parameters);
  int parameterCount() const { return 4 + static_cast<int>(distortion.size()); }
  /// "fx", "fy", "cx", "cy", "k1", ... in the order of parameters().
  std::vector<std::string> parameterNames() const;
};

/// Pixel of a point with derivatives.
struct Projection {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> J_px_p = Eigen::Matrix<double, 2, 3>::Zero();                              ///< by p_camera
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, Camera::kMaxParameters> J_px_parameters;  ///< by parameters()
};

/// Pixel of a point in the camera frame [m]: px = (fx m_x + cx, fy m_y + cy), m = (x, y) / z distorted by OpenCV's formulas (equidistant:
/// by the angle from the axis, cv::fisheye). Nothing where the model is not valid: z <= 0 for the pinhole models, and beyond the radius
/// (equidistant: the angle) where the radial part first stops growing, so that a point far outside cannot fold back into the picture.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& p_camera);
std::optional<Projection> projectWithJacobians(const Camera& camera, const Eigen::Vector3d& p_camera);

/// Unit ray through a pixel, in the camera frame; project() of it gives the pixel back to 1e-9 px. Nothing where the model has no such ray.
std::optional<Eigen::Vector3d> unproject(const Camera& camera, const Eigen::Vector2d& px);

/// Reads a camera as ROS writes it (camera_calibration's file with poecal's optional standard_deviation, or a camera_info message as
/// `ros2 topic echo` prints it), as OpenCV's FileStorage does, as Kalibr does (a camchain of one camera), or K and D with the size.
///
/// Coefficients are told by their number: none, 4, 5, 8, 12 or 14 of OpenCV's, 4 of equidistant (fisheye). The model is the one that is
/// named, or the smallest that has all coefficients that are not zero. A skew that moves the picture's top against its bottom by less
/// than 1 px is dropped with a remark.
/// @throws FileError: missing keys, unknown keys beside a distortion_model, an unknown model, another number of coefficients, a tilted
/// sensor (tau_x, tau_y), a larger skew, focal lengths or a size that is not positive, a cropped or binned picture, several cameras, a
/// principal point that is the middle of a picture with width and height exchanged or lies beyond its middle by 1.5 of its sides (one that
/// lies outside of it is a remark).
Camera readCamera(const std::filesystem::path& file);
/// readCamera() for pictures at hand: K and D alone give a camera of 0 x 0 pixels, whose size is the pictures'.
Camera readCameraOfPictures(const std::filesystem::path& file);
std::string cameraYaml(const Camera& camera);

/// Every model, for lists of what may be chosen.
inline constexpr DistortionModel kDistortionModels[] = {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial,
                                                        DistortionModel::kEquidistant, DistortionModel::kThinPrism};
const char* distortionModelName(DistortionModel model);
/// The model of that name, or nothing.
std::optional<DistortionModel> findDistortionModel(const std::string& name);
/// Number of coefficients: 5, 8, 4, 12.
int distortionCount(DistortionModel model);

}  // namespace poecal
