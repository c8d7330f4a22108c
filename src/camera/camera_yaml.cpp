#include "camera/camera_yaml.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "poecal/core/text.hpp"

namespace poecal {
namespace {

DistortionModel parseModel(const YamlNode& node) {
  const std::string name = node.text();
  if (const auto model = findDistortionModel(name)) return *model;
  std::string known;
  for (const DistortionModel model : kDistortionModels) known += (known.empty() ? "" : ", ") + std::string(distortionModelName(model));
  node.fail(fmt::format("is '{}', expected one of: {}", name, known));
}

int positiveInteger(const YamlNode& node) {
  const int value = node.integer();
  if (value <= 0) node.fail(fmt::format("is {}, expected a positive number of pixels", value));
  return value;
}

/// A matrix as OpenCV and ROS write it, row by row.
struct MatrixYaml {
  YamlNode data;
  Eigen::VectorXd values;
};

MatrixYaml parseMatrix(const YamlNode& node) {
  node.checkKeys({"rows", "cols", "data"});
  const int rows = node["rows"].integer(), cols = node["cols"].integer();
  MatrixYaml matrix{node["data"], node["data"].vector()};
  if (rows < 0 || cols < 0 || static_cast<long>(rows) * cols != static_cast<long>(matrix.values.size())) {
    matrix.data.fail(fmt::format("{} numbers, expected rows * cols = {} * {}", matrix.values.size(), rows, cols));
  }
  return matrix;
}

MatrixYaml parseMatrix(const YamlNode& node, int rows, int cols) {
  MatrixYaml matrix = parseMatrix(node);
  if (node["rows"].integer() != rows || node["cols"].integer() != cols) {
    node.fail(fmt::format("{} x {}, expected {} x {}", node["rows"].integer(), node["cols"].integer(), rows, cols));
  }
  return matrix;
}

void parseCameraMatrix(const YamlNode& node, Camera& camera) {
  const auto [data, K] = parseMatrix(node, 3, 3);
  if (K(1) != 0.0) data.fail(fmt::format("skew {}, expected 0", formatNumber(K(1))));
  if (K(3) != 0.0 || K(6) != 0.0 || K(7) != 0.0 || K(8) != 1.0) data.fail("expected [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  if (!(K(0) > 0.0) || !(K(4) > 0.0)) {
    data.fail(fmt::format("focal lengths {} and {}, expected positive numbers of pixels", formatNumber(K(0)), formatNumber(K(4))));
  }
  camera.fx = K(0);
  camera.cx = K(2);
  camera.fy = K(4);
  camera.cy = K(5);
}

Eigen::VectorXd parseDistortion(const YamlNode& node, DistortionModel model) {
  const auto [data, stated] = parseMatrix(node);
  const Eigen::Index count = distortionCount(model);
  const bool k3_left_out = model == DistortionModel::kPlumbBob && stated.size() == 4;
  if (stated.size() != count && stated.size() != 0 && !k3_left_out) {
    data.fail(fmt::format("{} coefficients, expected {}{} for {} (or none)", stated.size(),
                          model == DistortionModel::kPlumbBob ? "4 or " : "", count, distortionModelName(model)));
  }
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(count);
  coefficients.head(stated.size()) = stated;
  return coefficients;
}

Eigen::VectorXd parseStandardDeviation(const YamlNode& node, const Camera& camera) {
  node.checkKeys({"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  const std::vector<std::string> names = camera.parameterNames();
  for (const char* coefficient : {"k3", "k4", "k5", "k6", "p1", "p2"}) {
    const bool of_the_model = std::find(names.begin(), names.end(), coefficient) != names.end();
    if (node.has(coefficient) && !of_the_model) {
      node[coefficient].fail(fmt::format("{} has no coefficient of this name", distortionModelName(camera.model)));
    }
  }
  Eigen::VectorXd deviations = Eigen::VectorXd::Constant(camera.parameterCount(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::optional<YamlNode> entry = node.find(names[k].c_str());
    if (!entry) continue;
    const double value = entry->number();
    if (value < 0.0) entry->fail(fmt::format("is {}, expected a number that is not negative", formatNumber(value)));
    deviations(static_cast<Eigen::Index>(k)) = value;
  }
  return deviations;
}

/// Lines of a matrix entry.
std::string matrixYaml(const char* key, int rows, int cols, const Eigen::VectorXd& data, const std::string& margin) {
  return fmt::format("{0}{1}:\n{0}  rows: {2}\n{0}  cols: {3}\n{0}  data: {4}\n", margin, key, rows, cols, yamlVector(data));
}

}  // namespace

Camera parseCamera(const YamlNode& node) {
  node.checkKeys({"image_width", "image_height", "camera_name", "camera_matrix", "distortion_model", "distortion_coefficients",
                  "rectification_matrix", "projection_matrix", "standard_deviation"});
  Camera camera;
  camera.width = positiveInteger(node["image_width"]);
  camera.height = positiveInteger(node["image_height"]);
  if (const auto name = node.find("camera_name")) camera.name = name->text();
  parseCameraMatrix(node["camera_matrix"], camera);
  camera.model = parseModel(node["distortion_model"]);
  camera.distortion = parseDistortion(node["distortion_coefficients"], camera.model);
  // These two speak of rectified pictures. poecal works on the pictures as taken: they are checked, and not used.
  if (const auto rectification = node.find("rectification_matrix")) parseMatrix(*rectification, 3, 3);
  if (const auto projection = node.find("projection_matrix")) parseMatrix(*projection, 3, 4);
  if (const auto deviation = node.find("standard_deviation")) camera.standard_deviation = parseStandardDeviation(*deviation, camera);
  return camera;
}

std::string cameraYamlBlock(const Camera& camera, int indent) {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  Eigen::VectorXd K(9), rectification(9), projection(12);
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  rectification << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0;
  projection << camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0;
  const int count = distortionCount(camera.model);
  Eigen::VectorXd distortion = Eigen::VectorXd::Zero(count);
  distortion.head(camera.distortion.size()) = camera.distortion;

  std::string text = fmt::format("{0}image_width: {1}\n{0}image_height: {2}\n{0}camera_name: {3}\n", margin, camera.width, camera.height,
                                 yamlText(camera.name));
  text += matrixYaml("camera_matrix", 3, 3, K, margin);
  text += fmt::format("{}distortion_model: {}\n", margin, distortionModelName(camera.model));
  text += matrixYaml("distortion_coefficients", 1, count, distortion, margin);
  text += matrixYaml("rectification_matrix", 3, 3, rectification, margin);
  text += matrixYaml("projection_matrix", 3, 4, projection, margin);

  std::string deviations;
  const std::vector<std::string> names = camera.parameterNames();
  for (Eigen::Index k = 0; k < camera.standard_deviation.size(); ++k) {
    const double value = camera.standard_deviation(k);
    if (std::isfinite(value)) deviations += fmt::format("{}  {}: {}\n", margin, names[static_cast<std::size_t>(k)], formatNumber(value));
  }
  if (!deviations.empty()) text += margin + "standard_deviation:\n" + deviations;
  return text;
}

Camera readCamera(const std::filesystem::path& file) { return parseCamera(YamlNode::load(file)); }

std::string cameraYaml(const Camera& camera) { return cameraYamlBlock(camera, 0); }

}  // namespace poecal
