#include "poecal/cell/known_registration.hpp"

#include <limits>

#include <fmt/format.h>

#include "cell/transform_names.hpp"
#include "core/yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

/// A deviation, which may be without bound (.inf): nothing is known there.
double deviation(const YamlNode& node) {
  if (!node.isSequence() && !node.isMap() && node.text() == ".inf") return std::numeric_limits<double>::infinity();
  const double sigma = node.positive();
  if (sigma < KnownTransform::kFixed) node.fail(fmt::format("is {}, expected {} or more, or 'fixed: true'", sigma, KnownTransform::kFixed));
  return sigma;
}

/// One number for all axes, or one for each.
Eigen::Vector3d deviations(const YamlNode& node) {
  if (!node.isSequence()) return Eigen::Vector3d::Constant(deviation(node));
  const std::vector<YamlNode> axes = node.items();
  if (axes.size() != 3) node.fail(fmt::format("has {} numbers, expected one, or one for each axis", axes.size()));
  return {deviation(axes[0]), deviation(axes[1]), deviation(axes[2])};
}

Vector6d sigmaOf(const YamlNode& node) {
  node.checkKeys({"rotation", "translation"});
  // First both, as an error must not leave a comma-initialisation half done: its end is asserted.
  const Eigen::Vector3d rotation = deviations(node["rotation"]), translation = deviations(node["translation"]);
  Vector6d sigma;
  sigma << rotation, translation;
  return sigma;
}

bool isFixed(const YamlNode& transform) {
  const auto fixed = transform.find("fixed");
  if (!fixed) return false;
  if (fixed->text() != "true" && fixed->text() != "false") fixed->fail(fmt::format("is '{}', expected true or false", fixed->text()));
  return fixed->text() == "true";
}

/// Its pose, beside which there may be words of how well it is known.
Eigen::Isometry3d poseOf(const YamlNode& node) {
  node.checkKeys({"position", "quaternion_xyzw", "fixed", "standard_deviation"});
  return poseFromQuaternion(node["position"].vector3(), readUnitQuaternion(node["quaternion_xyzw"]));
}

/// @param of_file  the file's own deviation of the transform.
KnownTransform knownTransform(const YamlNode& node, const std::optional<YamlNode>& of_file) {
  KnownTransform known;
  known.T = poseOf(node);
  const std::optional<YamlNode> own = node.find("standard_deviation");
  const bool fixed = isFixed(node);
  if (fixed && own) own->fail("is stated of a transform that is fixed, expected one of the two");
  if (fixed) return known;
  if (!own && !of_file) node.fail("says neither 'fixed: true' nor 'standard_deviation: {rotation: [rad], translation: [m]}'");
  known.sigma = sigmaOf(own ? *own : *of_file);
  return known;
}

}  // namespace

Registration readRegistration(const std::filesystem::path& file) {
  const YamlNode root = YamlNode::load(file);
  root.checkFormat("poecal-registration/1");
  Registration registration;
  if (root.has("T_camera_flange")) registration.setup = Setup::kEyeInHand;
  registration.T_camera_near = poseOf(root[nearName(registration).c_str()]);
  registration.T_far_target = poseOf(root[farName(registration).c_str()]);
  return registration;
}

void readKnownRegistration(const std::filesystem::path& file, Registration& registration) {
  const YamlNode root = YamlNode::load(file);
  root.checkFormat("poecal-registration/1");
  const std::string near = nearName(registration), far = farName(registration);
  if (const auto setup = root.find("setup"); setup && setup->text() != setupName(registration.setup)) {
    setup->fail(fmt::format("is {}, but the capture's is {}", setup->text(), setupName(registration.setup)));
  }
  for (const std::string& key : root.keys()) {
    if (key.starts_with("T_") && key != near && key != far) root.failAtKey(key, fmt::format("is not known, expected {} or {}", near, far));
  }
  const std::optional<YamlNode> deviations = root.find("standard_deviation");
  const auto of_file = [&](const std::string& key) { return deviations ? deviations->find(key.c_str()) : std::nullopt; };
  if (const auto node = root.find(near.c_str())) registration.known_near = knownTransform(*node, of_file(near));
  if (const auto node = root.find(far.c_str())) registration.known_far = knownTransform(*node, of_file(far));
  if (!registration.known_near && !registration.known_far) root.fail(fmt::format("holds no transform, expected {} or {}", near, far));
}

}  // namespace poecal
