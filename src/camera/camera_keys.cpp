#include "camera/camera_keys.hpp"

#include <algorithm>
#include <cctype>
#include <initializer_list>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace poecal {
namespace {

using Keys = std::initializer_list<const char*>;

// ROS' file, camera_info of ROS 2 and ROS 1, OpenCV's samples and tutorials, Kalibr.
constexpr Keys kWidth = {"image_width", "width", "image_Width", "imageWidth"};
constexpr Keys kHeight = {"image_height", "height", "image_Height", "imageHeight"};
constexpr Keys kSize = {"resolution", "cameraResolution", "image_size", "imageSize"};
constexpr Keys kMatrix = {"camera_matrix", "k", "K", "cameraMatrix", "Camera_Matrix", "intrinsics", "intrinsic_matrix", "mtx"};
constexpr Keys kDistortion = {
    "distortion_coefficients", "d",          "D",   "distCoeffs", "dist_coeffs", "dist_coeff", "Distortion_Coefficients",
    "distortion_coeffs",       "distortion", "dist"};
constexpr Keys kModel = {"distortion_model"};
constexpr Keys kName = {"camera_name"};
constexpr Keys kRectification = {"rectification_matrix", "r", "R"};
constexpr Keys kProjection = {"projection_matrix", "p", "P"};
constexpr Keys kDeviation = {"standard_deviation"};
// What says nothing about the lens, or is looked at by checkRegion() and checkProjection().
constexpr Keys kOthers = {"header",       "binning_x", "binning_y", "roi",           "camera_model",     "rostopic",
                          "cam_overlaps", "T_cn_cnm1", "T_cam_imu", "fisheye_model", "timeshift_cam_imu"};

std::optional<YamlNode> findOne(const YamlNode& map, const Keys& names) {
  std::optional<YamlNode> found;
  for (const char* name : names) {
    const std::optional<YamlNode> node = map.find(name);
    if (node && found) node->fail(fmt::format("stands beside {}, expected one of them", found->name()));
    if (node) found = node;
  }
  return found;
}

YamlNode needOne(const YamlNode& map, const Keys& names) {
  if (const auto found = findOne(map, names)) return *found;
  return map[*names.begin()];
}

bool isKnown(const std::string& key) {
  for (const Keys& names :
       {kWidth, kHeight, kSize, kMatrix, kDistortion, kModel, kName, kRectification, kProjection, kDeviation, kOthers}) {
    if (std::find(names.begin(), names.end(), key) != names.end()) return true;
  }
  return false;
}

/// cam0, cam1...
bool isKalibrCamera(const std::string& key) {
  return key.size() > 3 && key.compare(0, 3, "cam") == 0 &&
         std::all_of(key.begin() + 3, key.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The map of the only camera: a camchain's, or the file itself.
YamlNode onlyCamera(const YamlNode& node) {
  std::vector<std::string> cameras;
  for (const std::string& key : node.keys()) {
    if (isKalibrCamera(key)) cameras.push_back(key);
  }
  if (cameras.empty()) return node;
  if (cameras.size() > 1) {
    node.fail(fmt::format("{} cameras ({}), expected one: keep the part of the one that took the pictures", cameras.size(),
                          fmt::join(cameras, ", ")));
  }
  return node[cameras.front().c_str()];
}

/// K is that of all of the sensor at full resolution.
void checkRegion(const YamlNode& map, const std::optional<YamlNode>& width, const std::optional<YamlNode>& height) {
  for (const char* name : {"binning_x", "binning_y"}) {
    const auto binning = map.find(name);
    if (binning && binning->number() > 1.0) {
      binning->fail(
          "the pictures are binned and camera_matrix is for those that are not: expected the intrinsics of the pictures as they are");
    }
  }
  const auto roi = map.find("roi");
  if (!roi) return;
  const auto wholeOrNone = [&](const char* name, const std::optional<YamlNode>& whole) {
    const auto part = roi->find(name);
    return !part || part->number() == 0.0 || (whole && part->number() == whole->number());
  };
  if (!wholeOrNone("x_offset", std::nullopt) || !wholeOrNone("y_offset", std::nullopt) || !wholeOrNone("width", width) ||
      !wholeOrNone("height", height)) {
    roi->fail("the pictures are a part of what camera_matrix is for: expected the intrinsics of the pictures as they are");
  }
}

void checkProjection(const YamlNode& map) {
  const auto projection = map.find("camera_model");
  if (projection && projection->text() != "pinhole") projection->fail(fmt::format("is '{}', expected pinhole", projection->text()));
}

/// The numbers of a list, or of a list of lists of equal lengths.
MatrixYaml parseList(const YamlNode& node) {
  const std::vector<YamlNode> items = node.items();
  if (items.empty() || !items.front().isSequence()) return {node, node.vector()};
  const Eigen::VectorXd first = items.front().vector();
  Eigen::VectorXd values(first.size() * static_cast<Eigen::Index>(items.size()));
  for (std::size_t row = 0; row < items.size(); ++row) {
    values.segment(static_cast<Eigen::Index>(row) * first.size(), first.size()) = items[row].vector(static_cast<int>(first.size()));
  }
  return {node, values};
}

}  // namespace

MatrixYaml parseMatrix(const YamlNode& node) {
  if (!node.isMap()) return parseList(node);
  node.checkKeys({"rows", "cols", "data", "dt", "type_id"});
  const int rows = node["rows"].integer(), cols = node["cols"].integer();
  MatrixYaml matrix{node["data"], node["data"].vector()};
  if (rows < 0 || cols < 0 || static_cast<long>(rows) * cols != static_cast<long>(matrix.values.size())) {
    matrix.data.fail(fmt::format("{} numbers, expected rows * cols = {} * {}", matrix.values.size(), rows, cols));
  }
  return matrix;
}

MatrixYaml parseMatrix(const YamlNode& node, int rows, int cols) {
  MatrixYaml matrix = parseMatrix(node);
  if (node.isMap() && (node["rows"].integer() != rows || node["cols"].integer() != cols)) {
    node.fail(fmt::format("{} x {}, expected {} x {}", node["rows"].integer(), node["cols"].integer(), rows, cols));
  }
  if (matrix.values.size() != static_cast<Eigen::Index>(rows) * cols) {
    node.fail(fmt::format("{} numbers, expected {} x {}", matrix.values.size(), rows, cols));
  }
  return matrix;
}

CameraKeys findCameraKeys(const YamlNode& node) {
  const YamlNode map = onlyCamera(node);
  const bool own_form = map.has("camera_matrix") && map.has("distortion_model");
  std::vector<std::string> unread;
  for (const std::string& key : map.keys()) {
    if (isKnown(key)) continue;
    if (own_form) {
      map.failAtKey(key, fmt::format("unknown key '{}', expected one of: image_width, image_height, camera_name, camera_matrix, "
                                     "distortion_model, distortion_coefficients, standard_deviation",
                                     key));
    }
    unread.push_back(key);
  }
  CameraKeys keys{.map = map,
                  .width = findOne(map, kWidth),
                  .height = findOne(map, kHeight),
                  .size = findOne(map, kSize),
                  .camera_matrix = needOne(map, kMatrix),
                  .distortion = needOne(map, kDistortion),
                  .model = findOne(map, kModel),
                  .name = findOne(map, kName),
                  .rectification = findOne(map, kRectification),
                  .projection = findOne(map, kProjection),
                  .standard_deviation = findOne(map, kDeviation),
                  .unread = std::move(unread)};
  if (const auto fisheye = map.find("fisheye_model")) keys.is_fisheye = fisheye->number() != 0.0;
  checkProjection(map);
  checkRegion(map, keys.width, keys.height);
  return keys;
}

}  // namespace poecal
