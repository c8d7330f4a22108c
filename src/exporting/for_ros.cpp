#include "poecal/exporting/for_ros.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/yaml.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/printable.hpp"
#include "poecal/core/text.hpp"
#include "poecal/exporting/dh.hpp"

namespace poecal {
namespace {

/// T_parent_child: child in parent.
struct StaticTransform {
  std::string parent, child;
  Eigen::Isometry3d T_parent_child;
};

const Camera& cameraOf(const Model& model) {
  if (!model.cell.camera) throw InvalidArgument("this model has no camera: it comes from poses of an instrument");
  return *model.cell.camera;
}

std::string stampedYaml(const StaticTransform& one) {
  const Eigen::Vector3d t = one.T_parent_child.translation();
  const Eigen::Vector4d c = quaternionXyzw(one.T_parent_child);
  return fmt::format(
      "- header: {{frame_id: {}}}\n  child_frame_id: {}\n  transform:\n    translation: {{x: {}, y: {}, z: {}}}\n"
      "    rotation: {{x: {}, y: {}, z: {}, w: {}}}\n",
      yamlText(one.parent), yamlText(one.child), formatNumber(t.x()), formatNumber(t.y()), formatNumber(t.z()), formatNumber(c(0)),
      formatNumber(c(1)), formatNumber(c(2)), formatNumber(c(3)));
}

/// A name as one word of a shell's command line.
std::string shellWord(const std::string& name) {
  const auto plain = [](char sign) {
    return std::isalnum(static_cast<unsigned char>(sign)) != 0 || (sign != '\0' && std::strchr("_./-", sign) != nullptr);
  };
  if (!name.empty() && std::all_of(name.begin(), name.end(), plain)) return name;
  std::string word = "'";
  for (const char sign : printableLine(name)) word += sign == '\'' ? "'\\''" : std::string(1, sign);
  return word + "'";
}

std::string commandLine(const StaticTransform& one) {
  const Eigen::Vector3d t = one.T_parent_child.translation();
  const Eigen::Vector4d c = quaternionXyzw(one.T_parent_child);
  return fmt::format(
      "# ros2 run tf2_ros static_transform_publisher --x {} --y {} --z {} --qx {} --qy {} --qz {} --qw {} --frame-id {} --child-frame-id "
      "{}\n",
      formatNumber(t.x()), formatNumber(t.y()), formatNumber(t.z()), formatNumber(c(0)), formatNumber(c(1)), formatNumber(c(2)),
      formatNumber(c(3)), shellWord(one.parent), shellWord(one.child));
}

StaticTransform turnedRound(const StaticTransform& one) { return {one.child, one.parent, one.T_parent_child.inverse()}; }

/// What a joint does beyond geometry, by the columns that hold it.
struct JointFlaws {
  std::array<double, 5> known{};  ///< in the order of kFlawColumns
  std::vector<std::string> others;
};

struct FlawColumn {
  const char *column, *effect, *parameter;
};
constexpr std::array<FlawColumn, 5> kFlawColumns{{{"gain", "joint_gain", "gain"},
                                                  {"eccentricity_sine", "joint_eccentricity", "sine"},
                                                  {"eccentricity_cosine", "joint_eccentricity", "cosine"},
                                                  {"half_gap", "joint_backlash", "half_gap"},
                                                  {"compliance", "joint_compliance", "compliance"}}};

JointFlaws flawsOf(const Model& model, std::size_t joint) {
  JointFlaws flaws;
  for (const AppliedEffect& applied : model.effects) {
    if (applied.effect.place() != Place{PlaceKind::kJoint, joint}) continue;
    bool known = false;
    const std::vector<EffectParameter>& parameters = applied.effect.parameters();
    std::vector<std::string> values;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const double value = applied.parameters(static_cast<Eigen::Index>(i));
      values.push_back(fmt::format("{} {}", parameters[i].name, formatNumber(value)));
      for (std::size_t column = 0; column < kFlawColumns.size(); ++column) {
        const FlawColumn& flaw = kFlawColumns[column];
        if (applied.effect.name() != flaw.effect || parameters[i].name != flaw.parameter) continue;
        flaws.known[column] += value;
        known = true;
      }
    }
    if (!known)
      flaws.others.push_back(fmt::format("{} by {}: {}", applied.effect.name(), applied.effect.driver().name(), fmt::join(values, ", ")));
  }
  return flaws;
}

}  // namespace

std::string cameraInfoYaml(const Model& model) {
  Camera camera = cameraOf(model);
  if (camera.model == DistortionModel::kThinPrism) {
    throw InvalidArgument("ROS has no lens model thin_prism, expected plumb_bob, rational_polynomial or equidistant");
  }
  camera.standard_deviation.resize(0);
  return cameraYaml(camera);
}

FrameNames frameNames(const Model& model) {
  FrameNames names;
  if (!model.base_link.empty()) names.base = model.base_link;
  if (!model.tip_link.empty()) names.flange = model.tip_link;
  return names;
}

std::string transformsYaml(const Model& model, const FrameNames& names) {
  static_cast<void>(cameraOf(model));
  const Registration& registration = model.cell.registration;
  const bool in_hand = registration.setup == Setup::kEyeInHand;
  const StaticTransform near{in_hand ? names.flange : names.base, names.camera, registration.T_camera_near.inverse()};
  const StaticTransform far{in_hand ? names.base : names.flange, names.target, registration.T_far_target};
  std::string text =
      "# Fixed transforms of the cell, both ways: child in parent [m; quaternion]. The camera's frame is optical: x right, y down, z "
      "forward.\n"
      "# As commands (tf2 takes one way of each, since frames form a tree):\n";
  text += commandLine(near) + commandLine(far);
  text += "format: poecal-transforms/1\ntransforms:\n";
  for (const StaticTransform& one : {near, turnedRound(near), far, turnedRound(far)}) text += stampedYaml(one);
  return text;
}

std::string jointTableCsv(const Model& model, const Arm& nominal) {
  const Arm& arm = *model.cell.arm;
  const DhTables dh = dhTables(nominal, arm);
  std::vector<std::string> header{"joint", "name", "type", "zero_offset", "tilt", "shift"};
  for (const char* state : {"nominal", "calibrated"}) {
    for (const char* part : {"axis_x", "axis_y", "axis_z", "point_x", "point_y", "point_z"})
      header.push_back(fmt::format("{}_{}", state, part));
  }
  for (const FlawColumn& flaw : kFlawColumns) header.emplace_back(flaw.column);
  header.emplace_back("other_effects");
  CsvWriter csv(header);
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const Joint &before = nominal.joints[k], &after = arm.joints[k];
    const bool turns = after.type == JointType::kRevolute;
    const AxisOffset offset = axisOffset(before, after);
    const DhRow &from = dh.nominal.rows[k], &to = dh.calibrated.rows[k];
    csv.cell(static_cast<int>(k + 1)).cell(after.name).cell(std::string(turns ? "revolute" : "prismatic"));
    csv.cell(turns ? std::remainder(to.theta - from.theta, 2.0 * M_PI) : to.d - from.d).cell(offset.tilt).cell(offset.shift);
    for (const Joint* joint : {&before, &after}) {
      const Eigen::Vector3d axis = joint->axis();
      for (const double x : axis) csv.cell(x);
      for (const double x : joint->anchor) csv.cell(x);
    }
    const JointFlaws flaws = flawsOf(model, k);
    for (const double value : flaws.known) csv.cell(value);
    csv.cell(fmt::format("{}", fmt::join(flaws.others, "; ")));
    csv.endRow();
  }
  return csv.str();
}

}  // namespace poecal
