// A camera file of ROS, OpenCV, Kalibr or poecal as one set of roles: each writes the same numbers under other keys.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/yaml.hpp"

namespace poecal {

/// A matrix as it stands in a file: a map of rows, cols and data, a list, or a list of lists; row by row.
struct MatrixYaml {
  YamlNode data;
  Eigen::VectorXd values;
};
/// @throws FileError: keys that a matrix does not have, another number of numbers than rows * cols says, rows of different lengths.
MatrixYaml parseMatrix(const YamlNode& node);
/// Where rows and cols are stated they must be these; otherwise the number of numbers must be rows * cols.
MatrixYaml parseMatrix(const YamlNode& node, int rows, int cols);

/// The parts of a camera file, whatever their keys are.
struct CameraKeys {
  YamlNode map;  ///< the camera's own map: that below cam0 in a camchain of Kalibr's
  std::optional<YamlNode> width, height;
  std::optional<YamlNode> size;  ///< [width, height], where these two do not stand alone
  YamlNode camera_matrix;        ///< K, or Kalibr's [fx, fy, cx, cy]
  YamlNode distortion;
  std::optional<YamlNode> model, name, rectification, projection, standard_deviation;
  bool is_fisheye = false;          ///< OpenCV's sample says so with a flag, without a name
  std::vector<std::string> unread;  ///< keys that mean nothing here
};

/// Finds the roles. @throws FileError: several cameras, a role that is missing or there twice, keys that are not known beside a
/// distortion_model and camera_matrix (in poecal's own form each key counts), a picture that is cropped or binned, Kalibr's other models.
CameraKeys findCameraKeys(const YamlNode& node);

}  // namespace poecal
