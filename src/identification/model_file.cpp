#include <fmt/format.h>

#include "camera/camera_yaml.hpp"
#include "core/yaml.hpp"
#include "effects/effect_yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/identification/model.hpp"
#include "robot/gravity_yaml.hpp"
#include "robot/robot_yaml.hpp"
#include "target/target_yaml.hpp"

namespace poecal {
namespace {

// Poses of an instrument have no camera: its frame and its tool take their places in the names.
std::string nearKey(const Model& model) {
  return fmt::format("T_{}_{}", model.cell.camera ? "camera" : "instrument", model.cell.registration.nearFrame());
}
std::string farKey(const Model& model) {
  return fmt::format("T_{}_{}", model.cell.registration.farFrame(), model.cell.camera ? "target" : "tool");
}

std::string rotationAndTranslation(const Vector6d& deviation) {
  return fmt::format("{{rotation: {}, translation: {}}}", yamlVector(deviation.head<3>()), yamlVector(deviation.tail<3>()));
}

std::string armDeviationYaml(const Model& model) {
  if (model.deviation.twists.empty()) return "";
  std::string text = "  standard_deviation:  # of the twists (w, v) in base, and of Gamma as a left perturbation (w, v)\n    joints:\n";
  for (std::size_t k = 0; k < model.deviation.twists.size(); ++k) {
    const Vector6d& twist = model.deviation.twists[k];
    text += fmt::format("    - {{name: {}, w: {}, v: {}}}\n", yamlText(model.cell.arm->joints[k].name), yamlVector(twist.head<3>()),
                        yamlVector(twist.tail<3>()));
  }
  if (model.deviation.gamma) text += fmt::format("    gamma: {}\n", rotationAndTranslation(*model.deviation.gamma));
  return text;
}

std::string registrationYaml(const Model& model) {
  const Registration& registration = model.cell.registration;
  std::string text = "registration:\n";
  text += fmt::format("  {}: {}\n  {}: {}\n", nearKey(model), yamlPose(registration.T_camera_near), farKey(model),
                      yamlPose(registration.T_far_target));
  if (!model.deviation.T_camera_near || !model.deviation.T_far_target) return text;
  text += "  standard_deviation:  # of left perturbations (w, v) in the first-named frame\n";
  text += fmt::format("    {}: {}\n    {}: {}\n", nearKey(model), rotationAndTranslation(*model.deviation.T_camera_near), farKey(model),
                      rotationAndTranslation(*model.deviation.T_far_target));
  return text;
}

void readRegistration(const YamlNode& root, Model& model) {
  const YamlNode node = root["registration"];
  Registration& registration = model.cell.registration;
  registration.setup = node.has("T_camera_flange") || node.has("T_instrument_flange") ? Setup::kEyeInHand : Setup::kEyeToHand;
  node.checkKeys({nearKey(model).c_str(), farKey(model).c_str(), "standard_deviation"});
  if (const auto setup = root.find("setup"); setup && setup->text() != setupName(registration.setup)) {
    setup->fail(
        fmt::format("is '{}', expected {} as the transforms of registration have it", setup->text(), setupName(registration.setup)));
  }
  registration.T_camera_near = readPose(node[nearKey(model).c_str()]);
  registration.T_far_target = readPose(node[farKey(model).c_str()]);
}

std::string driverRangesYaml(const DriverRanges& ranges) {
  if (ranges.empty()) return "";
  std::string text = "driver_ranges:  # of the capture that the effects were found in\n";
  for (const auto& [driver, range] : ranges) {
    text += fmt::format("  {}: [{}, {}]\n", driver, formatNumber(range.first), formatNumber(range.second));
  }
  return text;
}

DriverRanges readDriverRanges(const YamlNode& node) {
  node.checkKeys({"stamp", "temperature", "payload"});
  DriverRanges ranges;
  for (const std::string& driver : node.keys()) {
    const YamlNode range = node[driver.c_str()];
    const Eigen::VectorXd ends = range.vector(2);
    if (!(ends(0) <= ends(1))) range.fail("expected the lower end first");
    ranges[driver] = {ends(0), ends(1)};
  }
  return ranges;
}

}  // namespace

RealArm realArm(const Model& model) {
  if (!model.cell.arm) throw InvalidArgument("this model has no arm");
  return {.arm = *model.cell.arm, .effects = model.effects, .gravity = model.gravity};
}

std::string modelYaml(const Model& model) {
  std::string text = "format: poecal-model/1\n";
  text += fmt::format("method: {}\n", model.method);
  text += fmt::format("setup: {}\n", setupName(model.cell.registration.setup));
  if (!model.urdf.empty()) {
    text += fmt::format("source: {{urdf: {}, base_link: {}, tip_link: {}}}\n", yamlText(model.urdf), yamlText(model.base_link),
                        yamlText(model.tip_link));
  }
  text += "robot:\n" + robotMapYaml(*model.cell.arm, 2) + armDeviationYaml(model);
  if (model.cell.camera) text += "camera:\n" + cameraYamlBlock(*model.cell.camera, 2);
  if (model.target) text += "target:\n" + targetYamlLines(*model.target, "  ");
  text += registrationYaml(model);
  text += fmt::format("gravity: {}\n", yamlVector(model.gravity));
  text += effectsYaml(model.effects);
  text += driverRangesYaml(model.driver_ranges);
  return text;
}

Model readModel(const std::filesystem::path& file) {
  const YamlNode root = YamlNode::load(file);
  root.checkFormat("poecal-model/1");
  root.checkKeys(
      {"format", "method", "setup", "source", "robot", "camera", "target", "registration", "gravity", "effects", "driver_ranges"});
  Model model;
  if (const auto method = root.find("method")) model.method = method->text();
  if (const auto source = root.find("source")) {
    source->checkKeys({"urdf", "base_link", "tip_link"});
    model.urdf = (*source)["urdf"].text();
    model.base_link = (*source)["base_link"].text();
    model.tip_link = (*source)["tip_link"].text();
  }
  model.cell.arm = readRobotMap(root["robot"]);
  if (const auto camera = root.find("camera")) model.cell.camera = parseCamera(*camera);
  if (const auto target = root.find("target")) model.target = parseTarget(*target);
  readRegistration(root, model);
  if (const auto gravity = root.find("gravity")) model.gravity = readGravity(*gravity);
  constexpr bool kAsFound = true;
  if (const auto effects = root.find("effects")) model.effects = readEffects(*effects, model.cell, kAsFound);
  if (const auto ranges = root.find("driver_ranges")) model.driver_ranges = readDriverRanges(*ranges);
  return model;
}

}  // namespace poecal
