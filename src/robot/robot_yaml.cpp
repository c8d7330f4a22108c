#include "robot/robot_yaml.hpp"

#include <cmath>

#include <fmt/format.h>

#include "geometry/pose_yaml.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/robot/robot_file.hpp"
#include "robot/arm_size.hpp"

namespace poecal {
namespace {

constexpr char kFormat[] = "poecal-robot/1";
constexpr double kUnitTolerance = 1e-6;  // six written decimals

JointType readType(const YamlNode& node) {
  const std::string type = node.text();
  if (type == "revolute") return JointType::kRevolute;
  if (type == "prismatic") return JointType::kPrismatic;
  node.fail(fmt::format("is '{}', expected revolute or prismatic", type));
}

Eigen::Vector3d readUnitAxis(const YamlNode& node) {
  const Eigen::Vector3d axis = node.vector3();
  if (std::abs(axis.norm() - 1.0) > kUnitTolerance) node.fail(fmt::format("length {:.6g}, expected a unit vector", axis.norm()));
  return axis;
}

JointLimits readLimits(const YamlNode& node, JointType type) {
  const Eigen::VectorXd values = node.vector(2);
  const JointLimits limits{values(0), values(1)};
  if (const auto problem = limitsProblem(type, limits)) node.fail("are " + *problem);
  return limits;
}

/// A point of the arm, in base at q = 0.
Eigen::Vector3d readPoint(const YamlNode& node) {
  const Eigen::Vector3d point = node.vector3();
  if (const auto problem = sizeProblem(point)) node.fail(*problem);
  return point;
}

Joint readJoint(const YamlNode& node) {
  node.checkKeys({"name", "type", "axis", "point", "limits", "standard_deviation"});
  const std::string name = node["name"].text();
  const JointType type = readType(node["type"]);
  const Eigen::Vector3d axis = readUnitAxis(node["axis"]);
  Joint joint;
  if (type == JointType::kRevolute) {
    joint = Joint::revolute(name, axis, readPoint(node["point"]));
  } else {
    const auto point = node.find("point");
    joint = Joint::prismatic(name, axis, point ? readPoint(*point) : Eigen::Vector3d::Zero());
  }
  if (const auto limits = node.find("limits")) joint.limits = readLimits(*limits, type);
  return joint;
}

LinkMass readLink(const YamlNode& node) {
  node.checkKeys({"mass", "com"});
  const YamlNode mass = node["mass"];
  if (const auto problem = massProblem(mass.number())) mass.fail("is " + *problem);
  return {mass.number(), readPoint(node["com"])};
}

Arm readArm(const YamlNode& node) {
  Arm arm;
  arm.name = node["name"].text();
  const YamlNode joints = node["joints"];
  for (const YamlNode& joint : joints.items()) arm.joints.push_back(readJoint(joint));
  if (arm.joints.empty()) joints.fail("is empty, expected at least one joint");
  const YamlNode flange = node["flange"];
  const Eigen::Isometry3d T_base_flange = readPose(flange);
  if (const auto problem = sizeProblem(T_base_flange.translation())) flange.fail(*problem);
  arm.gamma = logSe3(T_base_flange);
  if (const auto links = node.find("links")) {
    for (const YamlNode& link : links->items()) arm.links.push_back(readLink(link));
    if (arm.links.size() != arm.joints.size()) {
      links->fail(fmt::format("{} links, expected one per joint: {}", arm.links.size(), arm.joints.size()));
    }
  }
  return arm;
}

std::string jointYaml(const Joint& joint) {
  const bool revolute = joint.type == JointType::kRevolute;
  std::string text =
      fmt::format("{{name: {}, type: {}, axis: {}", yamlText(joint.name), revolute ? "revolute" : "prismatic", yamlVector(joint.axis()));
  if (revolute || !joint.anchor.isZero(0.0)) text += fmt::format(", point: {}", yamlVector(joint.anchor));
  if (joint.limits) text += fmt::format(", limits: {}", yamlVector(Eigen::Vector2d(joint.limits->lower, joint.limits->upper)));
  return text + "}";
}

}  // namespace

Arm readRobotMap(const YamlNode& node) {
  node.checkKeys({"name", "joints", "flange", "links", "standard_deviation"});
  return readArm(node);
}

std::string robotMapYaml(const Arm& arm, int indent) {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string text = fmt::format("{}name: {}\n{}joints:\n", margin, yamlText(arm.name), margin);
  for (const Joint& joint : arm.joints) text += fmt::format("{}  - {}\n", margin, jointYaml(joint));
  text += fmt::format("{}flange: {}\n", margin, yamlPose(expSe3(arm.gamma)));
  if (!arm.links.empty()) text += margin + "links:\n";
  for (const LinkMass& link : arm.links) {
    text += fmt::format("{}  - {{mass: {}, com: {}}}\n", margin, formatNumber(link.mass), yamlVector(link.com));
  }
  return text;
}

Arm readRobotYaml(const std::filesystem::path& file) {
  const YamlNode root = YamlNode::load(file);
  root.checkFormat(kFormat);
  root.checkKeys({"format", "name", "joints", "flange", "links", "standard_deviation"});
  return readArm(root);
}

std::string robotYaml(const Arm& arm) { return fmt::format("format: {}\n", kFormat) + robotMapYaml(arm, 0); }

Arm readArm(const std::filesystem::path& file, const std::string& base_link, const std::string& tip_link) {
  if (!isUrdf(file)) return readRobotYaml(file);
  if (base_link.empty() || tip_link.empty()) throw InvalidArgument("a URDF needs --base-link and --tip-link");
  return readUrdf(file, base_link, tip_link);
}

}  // namespace poecal
