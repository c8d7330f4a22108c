#include "poecal/exporting/dh.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();

Eigen::Isometry3d turn(double angle, const Eigen::Vector3d& axis) { return Eigen::Isometry3d(Eigen::AngleAxisd(angle, axis)); }
Eigen::Isometry3d shift(double x, double y, double z) { return Eigen::Isometry3d(Eigen::Translation3d(x, y, z)); }

Eigen::Isometry3d motionOf(const DhRow& row, double q, JointType type) {
  const bool turns = type == JointType::kRevolute;
  return turn(row.theta + (turns ? q : 0.0), kZ) * shift(0.0, 0.0, row.d + (turns ? 0.0 : q)) * shift(row.a, 0.0, 0.0) *
         turn(row.alpha, Eigen::Vector3d::UnitX()) * turn(row.beta, Eigen::Vector3d::UnitY());
}

/// An axis as a line.
struct AxisLine {
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), direction = kZ;
};

/// Seen from a frame; a sliding joint's line passes through its origin.
AxisLine lineFrom(const Eigen::Isometry3d& T_base_frame, const Joint& joint) {
  const Eigen::Isometry3d T_frame_base = T_base_frame.inverse();
  AxisLine line;
  line.direction = T_frame_base.linear() * joint.axis();
  if (joint.type == JointType::kRevolute) line.point = T_frame_base * joint.anchor;
  return line;
}

bool nearlyParallel(const AxisLine& line) {
  constexpr double kParallel = 0.1;  // [rad]: there the common normal moves ten times as far as the axis
  return line.direction.cross(kZ).norm() < std::sin(kParallel);
}

/// Of the two common normals, which point either way, the one whose theta is nearer to `near`.
DhRow byCommonNormal(const AxisLine& line, double near) {
  DhRow row;
  Eigen::Vector3d normal = kZ.cross(line.direction).normalized();
  if (normal.x() * std::cos(near) + normal.y() * std::sin(near) < 0.0) normal = -normal;
  row.theta = std::atan2(normal.y(), normal.x());
  row.alpha = std::atan2(kZ.cross(line.direction).dot(normal), line.direction.z());
  row.a = normal.dot(line.point);
  // The point of z where the common normal begins: across it, both lines are seen at one place.
  const Eigen::Vector3d across = normal.cross(kZ);
  row.d = line.point.z() - line.direction.z() * across.dot(line.point) / across.dot(line.direction);
  return row;
}

DhRow byHayati(const AxisLine& line, double near) {
  constexpr double kNone = 1e-9;  // [m]: axes that coincide have no direction between them
  DhRow row;
  row.rule = DhRule::kHayati;
  const Eigen::Vector3d crossing = line.point - line.direction * (line.point.z() / line.direction.z());
  row.a = crossing.head<2>().norm();
  row.theta = row.a > kNone ? std::atan2(crossing.y(), crossing.x()) : near;
  if (std::cos(row.theta - near) < 0.0) {
    row.a = -row.a;
    row.theta = std::remainder(row.theta + M_PI, 2.0 * M_PI);
  }
  const Eigen::Vector3d u = Eigen::AngleAxisd(-row.theta, kZ) * line.direction;
  row.beta = std::asin(std::clamp(u.x(), -1.0, 1.0));
  row.alpha = std::atan2(-u.y(), u.z());
  return row;
}

/// @param like  the nominal table, whose rules and signs are kept; nullptr: this is it.
DhTable tableOf(const Arm& arm, const DhTable* like) {
  DhTable table;
  const AxisLine first = lineFrom(Eigen::Isometry3d::Identity(), arm.joints.front());
  table.base.linear() = Eigen::Quaterniond::FromTwoVectors(kZ, first.direction).toRotationMatrix();
  table.base.translation() = first.point - first.direction * first.direction.dot(first.point);
  Eigen::Isometry3d T_base_frame = table.base;
  for (std::size_t k = 0; k + 1 < arm.joints.size(); ++k) {
    const AxisLine next = lineFrom(T_base_frame, arm.joints[k + 1]);
    const double near = like == nullptr ? 0.0 : like->rows[k].theta;
    const bool parallel = like == nullptr ? nearlyParallel(next) : like->rows[k].rule == DhRule::kHayati;
    table.rows.push_back(parallel ? byHayati(next, near) : byCommonNormal(next, near));
    T_base_frame = T_base_frame * motionOf(table.rows.back(), 0.0, arm.joints[k].type);
  }
  const Eigen::Isometry3d T_frame_flange = T_base_frame.inverse() * expSe3(arm.gamma);
  const Eigen::Matrix3d& R = T_frame_flange.linear();
  DhRow last;
  last.d = T_frame_flange.translation().z();
  // The turn about z that is nearest to R.
  const double x = R(0, 0) + R(1, 1), y = R(1, 0) - R(0, 1);
  last.theta = std::hypot(x, y) > 1e-9 ? std::atan2(y, x) : 0.0;
  table.rows.push_back(last);
  table.tool = motionOf(last, 0.0, JointType::kRevolute).inverse() * T_frame_flange;
  return table;
}

std::string rowText(const DhRow& row) {
  constexpr double kRounding = 1e-15;  // of what is 0 in a data sheet
  const auto number = [](double value) { return formatNumber(std::abs(value) < kRounding ? 0.0 : value); };
  return fmt::format("{{a: {}, alpha: {}, d: {}, theta: {}, beta: {}}}", number(row.a), number(row.alpha), number(row.d), number(row.theta),
                     number(row.beta));
}

bool isNone(const Eigen::Isometry3d& T) {
  constexpr double kNone = 1e-9;  // [m], [rad]: rounding of a file's digits
  return T.translation().norm() < kNone && rotationAngle(T.linear()) < kNone;
}

}  // namespace

bool DhTable::plain() const { return isNone(base) && isNone(tool); }

DhTables dhTables(const Arm& nominal, const Arm& calibrated) {
  if (nominal.joints.empty()) throw InvalidArgument("the nominal arm has no joints");
  const std::string difference = differenceOfArms(nominal, calibrated);
  if (!difference.empty()) throw InvalidArgument("the calibrated arm is not the nominal one: " + difference);
  DhTables tables;
  tables.nominal = tableOf(nominal, nullptr);
  tables.calibrated = tableOf(calibrated, &tables.nominal);
  return tables;
}

Eigen::Isometry3d dhForward(const DhTable& table, const Arm& arm, const Eigen::VectorXd& q) {
  if (q.size() != arm.jointCount()) throw InvalidArgument(fmt::format("{} joint positions, expected {}", q.size(), arm.jointCount()));
  Eigen::Isometry3d T = table.base;
  for (std::size_t k = 0; k < table.rows.size(); ++k) T = T * motionOf(table.rows[k], q(static_cast<Eigen::Index>(k)), arm.joints[k].type);
  return T * table.tool;
}

std::string dhYaml(const DhTables& tables, const Arm& arm) {
  std::string text =
      "# T_base_flange(q) = base A_1(q_1) ... A_n(q_n) tool, A = Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta) [m, rad]; q is added to theta\n"
      "# (revolute) or d (prismatic). rule dh: by the common normal, beta is 0. rule hayati, of nearly parallel axes: d is 0.\n"
      "format: poecal-dh/1\n";
  text += fmt::format("nominal_is_plain: {}  # true: the nominal arm is its rows alone, without base and tool\n", tables.nominal.plain());
  text += fmt::format("base:\n  nominal: {}\n  calibrated: {}\n", yamlPose(tables.nominal.base), yamlPose(tables.calibrated.base));
  text += "joints:\n";
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    text += fmt::format("- name: {}\n  type: {}\n  rule: {}\n  nominal: {}\n  calibrated: {}\n", yamlText(arm.joints[k].name),
                        arm.joints[k].type == JointType::kRevolute ? "revolute" : "prismatic",
                        tables.nominal.rows[k].rule == DhRule::kDh ? "dh" : "hayati", rowText(tables.nominal.rows[k]),
                        rowText(tables.calibrated.rows[k]));
  }
  text += fmt::format("tool:\n  nominal: {}\n  calibrated: {}\n", yamlPose(tables.nominal.tool), yamlPose(tables.calibrated.tool));
  return text;
}

}  // namespace poecal
