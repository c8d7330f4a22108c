// The camera: pinhole with a distortion model, projection with derivatives, and its inverse.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace poecal {

/// Names as in camera.yaml: plumb_bob (k1 k2 p1 p2 k3), rational_polynomial (k1 k2 p1 p2 k3 k4 k5 k6), equidistant (k1 k2 k3 k4).
enum class DistortionModel { kPlumbBob, kRationalPolynomial, kEquidistant };

/// Intrinsics. Pixels follow OpenCV: the centre of the top-left pixel is (0, 0).
struct Camera {
  std::string name = "camera";
  int width = 0;
  int height = 0;
  DistortionModel model = DistortionModel::kPlumbBob;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  Eigen::VectorXd distortion;                     ///< 5, 8 or 4 coefficients by model, in OpenCV's order; missing trailing ones are zero
  /// Empty, or one per parameter (as parameters()); NaN where the file states none.
  Eigen::VectorXd standard_deviation;

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
  Eigen::Matrix<double, 2, 3> J_px_p = Eigen::Matrix<double, 2, 3>::Zero();          ///< by p_camera
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 12> J_px_parameters;  ///< by parameters()
};

/// Pixel of a point in the camera frame [m]: px = (fx m_x + cx, fy m_y + cy), m = (x, y) / z distorted by OpenCV's formulas (equidistant:
/// by the angle from the axis, cv::fisheye). Nothing where the model is not valid: z <= 0 for the pinhole models, and beyond the radius
/// (equidistant: the angle) where the radial part first stops growing, so that a point far outside cannot fold back into the picture.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& p_camera);
std::optional<Projection> projectWithJacobians(const Camera& camera, const Eigen::Vector3d& p_camera);

/// Unit ray through a pixel, in the camera frame; project() of it gives the pixel back to 1e-9 px. Nothing where the model has no such ray.
std::optional<Eigen::Vector3d> unproject(const Camera& camera, const Eigen::Vector2d& px);

/// Reads the YAML of ROS camera_info / camera_calibration, with poecal's optional standard_deviation.
/// @throws FileError: missing keys, an unknown model, a wrong number of coefficients (plumb_bob 4 or 5 and equidistant 4; 0 stands for
/// none), focal lengths that are not positive, a size that is not positive.
Camera readCamera(const std::filesystem::path& file);
std::string cameraYaml(const Camera& camera);

/// Every model, for lists of what may be chosen.
inline constexpr DistortionModel kDistortionModels[] = {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial,
                                                        DistortionModel::kEquidistant};
const char* distortionModelName(DistortionModel model);
/// The model of that name, or nothing.
std::optional<DistortionModel> findDistortionModel(const std::string& name);
/// Number of coefficients: 5, 8, 4.
int distortionCount(DistortionModel model);

}  // namespace poecal
