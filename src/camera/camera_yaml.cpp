#include "camera/camera_yaml.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "camera/camera_keys.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

/// Other names under which people have these models: Kalibr's, RealSense's, OpenCV's module.
struct OtherName {
  const char* name;
  DistortionModel model;
};
constexpr OtherName kOtherNames[] = {{"radtan", DistortionModel::kPlumbBob},
                                     {"brown_conrady", DistortionModel::kPlumbBob},
                                     {"none", DistortionModel::kPlumbBob},
                                     {"", DistortionModel::kPlumbBob},
                                     {"fisheye", DistortionModel::kEquidistant},
                                     {"equi", DistortionModel::kEquidistant},
                                     {"rational", DistortionModel::kRationalPolynomial}};

DistortionModel parseModel(const YamlNode& node) {
  const std::string name = node.text();
  if (const auto model = findDistortionModel(name)) return *model;
  for (const OtherName& other : kOtherNames) {
    if (name == other.name) return other.model;
  }
  std::string known;
  for (const DistortionModel model : kDistortionModels) known += (known.empty() ? "" : ", ") + std::string(distortionModelName(model));
  node.fail(fmt::format("is '{}', expected one of: {}", name, known));
}

int pixels(const YamlNode& node) {
  const double value = node.number();
  if (!(value > 0.0) || value != std::floor(value) || value > std::numeric_limits<int>::max()) {
    node.fail(fmt::format("is {}, expected a positive number of pixels", value));
  }
  return static_cast<int>(value);
}

void readSize(const CameraKeys& keys, SizeKeys size, Camera& camera) {
  if (!keys.size && !keys.width && !keys.height && size == SizeKeys::kMayBeMissing) return;
  if (keys.size && !keys.width && !keys.height) {
    const std::vector<YamlNode> items = keys.size->items();
    if (items.size() != 2) keys.size->fail(fmt::format("{} numbers, expected width and height", items.size()));
    camera.width = pixels(items[0]);
    camera.height = pixels(items[1]);
    return;
  }
  camera.width = pixels(keys.width ? *keys.width : keys.map["image_width"]);
  camera.height = pixels(keys.height ? *keys.height : keys.map["image_height"]);
}

/// No lens model here has a skew; one that nobody would see in a picture is let go.
void dropSkew(const YamlNode& node, double skew, Camera& camera) {
  if (skew == 0.0) return;
  // Without a size: that of a picture whose middle is the principal point.
  const double height = camera.height > 0 ? camera.height : 2.0 * camera.cy + 1.0;
  const double across_px = std::abs(skew) * height / camera.fy;
  constexpr double kUnseen_px = 1.0;
  if (!(across_px < kUnseen_px)) {
    node.fail(
        fmt::format("skew {} moves the picture's top by {:.1f} px against its bottom, expected less than 1 px: calibrate without skew",
                    formatNumber(skew), across_px));
  }
  camera.remarks.push_back(
      fmt::format("skew {} is dropped: it moves the picture's top by {:.2f} px against its bottom", formatNumber(skew), across_px));
}

void readCameraMatrix(const YamlNode& node, Camera& camera) {
  double skew = 0.0;
  if (node.isSequence() && node.items().size() == 4 && !node.items().front().isSequence()) {
    const Eigen::VectorXd f = node.vector();  // Kalibr
    camera.fx = f(0), camera.fy = f(1), camera.cx = f(2), camera.cy = f(3);
  } else {
    const auto [data, K] = parseMatrix(node, 3, 3);
    if (K(3) != 0.0 || K(6) != 0.0 || K(7) != 0.0 || K(8) != 1.0) data.fail("expected [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
    camera.fx = K(0), camera.fy = K(4), camera.cx = K(2), camera.cy = K(5);
    skew = K(1);
  }
  const YamlNode numbers = node.isMap() ? node["data"] : node;
  if (!(camera.fx > 0.0) || !(camera.fy > 0.0)) {
    numbers.fail(
        fmt::format("focal lengths {} and {}, expected positive numbers of pixels", formatNumber(camera.fx), formatNumber(camera.fy)));
  }
  dropSkew(numbers, skew, camera);
}

/// One more than the index of the last coefficient that is not zero.
Eigen::Index lastUsed(const Eigen::VectorXd& k) {
  Eigen::Index count = k.size();
  while (count > 0 && k(count - 1) == 0.0) --count;
  return count;
}

void readEquidistant(const YamlNode& data, const Eigen::VectorXd& stated, Camera& camera) {
  if (lastUsed(stated) > 4 || (stated.size() < 4 && stated.size() != 0)) {
    data.fail(fmt::format("{} coefficients, expected 4 for equidistant (or none)", stated.size()));
  }
  camera.distortion = Eigen::VectorXd::Zero(4);
  const Eigen::Index count = std::min<Eigen::Index>(4, stated.size());
  camera.distortion.head(count) = stated.head(count);
}

/// OpenCV's coefficients: their number and those that are not zero say which of its models they are.
void readPinhole(const YamlNode& data, const Eigen::VectorXd& stated, Camera& camera) {
  constexpr Eigen::Index kCounts[] = {0, 4, 5, 8, 12, 14};
  if (std::find(std::begin(kCounts), std::end(kCounts), stated.size()) == std::end(kCounts)) {
    data.fail(
        fmt::format("{} coefficients, expected 4, 5, 8, 12 or 14 for {} (or none)", stated.size(), distortionModelName(camera.model)));
  }
  const Eigen::Index used = lastUsed(stated);
  if (used > distortionCount(DistortionModel::kThinPrism)) {
    data.fail("the last two, tau_x and tau_y, tilt the sensor: expected zeros there, or a calibration without them");
  }
  for (const DistortionModel larger : {DistortionModel::kRationalPolynomial, DistortionModel::kThinPrism}) {
    if (used > distortionCount(camera.model)) camera.model = larger;
  }
  camera.distortion = Eigen::VectorXd::Zero(distortionCount(camera.model));
  camera.distortion.head(used) = stated.head(used);
}

void readDistortion(const CameraKeys& keys, Camera& camera) {
  camera.model = keys.model ? parseModel(*keys.model) : keys.is_fisheye ? DistortionModel::kEquidistant : DistortionModel::kPlumbBob;
  const auto [data, stated] = parseMatrix(keys.distortion);
  if (camera.model == DistortionModel::kEquidistant) {
    readEquidistant(data, stated, camera);
  } else {
    readPinhole(data, stated, camera);
  }
  if (!keys.model && !keys.is_fisheye && stated.size() == 4) {
    camera.remarks.emplace_back(
        "4 coefficients without a distortion_model are read as k1 k2 p1 p2; a fisheye's need distortion_model: equidistant");
  }
}

Eigen::VectorXd parseStandardDeviation(const YamlNode& node, const Camera& camera) {
  node.checkKeys({"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"});
  const std::vector<std::string> names = camera.parameterNames();
  for (const char* coefficient : {"k3", "k4", "k5", "k6", "p1", "p2", "s1", "s2", "s3", "s4"}) {
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

/// How far a principal point is from the middle of a picture, as a share of its sides: the larger of both.
double shareFromMiddle(const Camera& camera, double width, double height) {
  return std::max(std::abs(camera.cx - 0.5 * (width - 1.0)) / width, std::abs(camera.cy - 0.5 * (height - 1.0)) / height);
}

/// A size and a principal point that are not of one picture. Of a model it may be what a fit made of it; of a lens's own file it is a
/// mistake.
void judgePrincipalPoint(const YamlNode& numbers, Camera& camera) {
  if (camera.width == 0 || camera.height == 0) return;
  constexpr double kMiddle = 0.05;  // where lenses are mounted; a sensor's side is cut by no more than some hundredths
  constexpr double kAside = 0.1;
  constexpr double kOutside = 0.5, kFarOutside = 1.5;
  const double stated = shareFromMiddle(camera, camera.width, camera.height), turned = shareFromMiddle(camera, camera.height, camera.width);
  if (stated > kAside && turned < kMiddle) {
    numbers.fail(
        fmt::format("the principal point ({:.6g}, {:.6g}) is the middle of a picture of {} x {} px, not of {} x {}: expected a lens and a "
                    "picture size of one camera; are width and height exchanged?",
                    camera.cx, camera.cy, camera.height, camera.width, camera.width, camera.height));
  }
  if (stated > kFarOutside) {
    numbers.fail(
        fmt::format("the principal point ({:.6g}, {:.6g}) is far outside of the picture of {} x {} px, expected it near the middle",
                    camera.cx, camera.cy, camera.width, camera.height));
  }
  if (stated <= kOutside) return;
  camera.remarks.push_back(
      fmt::format("its principal point ({:.0f}, {:.0f}) px is outside the picture of {} x {} px, expected it near the middle", camera.cx,
                  camera.cy, camera.width, camera.height));
}

Camera readFrom(const std::filesystem::path& file, SizeKeys size) {
  const YamlNode root = YamlNode::load(file, YamlNode::Documents::kFirstOfMany);
  Camera camera = parseCamera(root, size);
  const YamlNode matrix = findCameraKeys(root).camera_matrix;
  judgePrincipalPoint(matrix.isMap() ? matrix["data"] : matrix, camera);
  return camera;
}

/// Lines of a matrix entry.
std::string matrixYaml(const char* key, int rows, int cols, const Eigen::VectorXd& data, const std::string& margin) {
  return fmt::format("{0}{1}:\n{0}  rows: {2}\n{0}  cols: {3}\n{0}  data: {4}\n", margin, key, rows, cols, yamlVector(data));
}

}  // namespace

Camera parseCamera(const YamlNode& node, SizeKeys size) {
  const CameraKeys keys = findCameraKeys(node);
  Camera camera;
  readSize(keys, size, camera);
  if (keys.name) camera.name = keys.name->text();
  readCameraMatrix(keys.camera_matrix, camera);
  readDistortion(keys, camera);
  // These two speak of rectified pictures. poecal works on the pictures as taken: they are checked, and not used.
  if (keys.rectification) parseMatrix(*keys.rectification, 3, 3);
  if (keys.projection) parseMatrix(*keys.projection, 3, 4);
  if (keys.standard_deviation) camera.standard_deviation = parseStandardDeviation(*keys.standard_deviation, camera);
  if (!keys.unread.empty()) camera.remarks.push_back(fmt::format("not read: {}", fmt::join(keys.unread, ", ")));
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

Camera readCamera(const std::filesystem::path& file) { return readFrom(file, SizeKeys::kNeeded); }

Camera readCameraOfPictures(const std::filesystem::path& file) { return readFrom(file, SizeKeys::kMayBeMissing); }

std::string cameraYaml(const Camera& camera) { return cameraYamlBlock(camera, 0); }

}  // namespace poecal
