#include "capture/column_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/numbered.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// Small letters and digits alone: "Rot_X [deg]" and "rotx" are one name.
std::string bareName(const std::string& name) {
  std::string bare;
  for (const char sign : name.substr(0, name.find_first_of("[("))) {
    const auto byte = static_cast<unsigned char>(sign);
    if (std::isalnum(byte) != 0) bare += static_cast<char>(std::tolower(byte));
  }
  for (const std::string_view unit : {"deg", "rad"}) {
    if (bare.size() > unit.size() && bare.ends_with(unit)) bare.resize(bare.size() - unit.size());
  }
  return bare;
}

/// Three names of an orientation, as controllers, trackers and people write them.
std::vector<std::array<std::string, 3>> orientationNames() {
  std::vector<std::array<std::string, 3>> names{
      {"roll", "pitch", "yaw"}, {"alpha", "beta", "gamma"}, {"phi", "theta", "psi"}, {"a", "b", "c"}, {"w", "p", "r"},
      {"u", "v", "w"},          {"r11", "r22", "r33"},      {"qi", "qj", "qk"}};
  // Neither e, as errors may be called, nor a1.., as joints are.
  for (const std::string prefix :
       {"r", "rot", "rotation", "euler", "o", "ori", "orientation", "rv", "rvec", "rotvec", "angle", "ang", "q", "quat", "quaternion"}) {
    names.push_back({prefix + "x", prefix + "y", prefix + "z"});
  }
  for (const std::string prefix : {"rot", "rotvec", "rvec", "euler"}) names.push_back({prefix + "1", prefix + "2", prefix + "3"});
  return names;
}

bool isJointName(const std::string& column, const Joint& joint) {
  const std::string bare = bareName(column), name = bareName(joint.name);
  return bare.size() > 1 && (name.starts_with(bare) || bare.starts_with(name));
}

bool isNumberedJoint(const std::string& column, int number) {
  const std::string bare = bareName(column);
  const auto is = [&](const char* prefix) { return numberAfter(bare, prefix) == number; };
  return is("q") || is("j") || is("joint") || is("jnt") || is("axis") || is("a") || is("theta") || is("angle") || is("jointangle") ||
         is("jointposition") || is("pos") || is("position");
}

}  // namespace

void requireKnownOrientation(const CsvTable& table) {
  for (const char* name : {"qx", "qy", "qz", "qw"}) {
    if (table.findColumn(name)) return;
  }
  const auto find = [&](const std::string& wanted) {
    return std::find_if(table.header().begin(), table.header().end(), [&](const std::string& name) { return bareName(name) == wanted; });
  };
  for (const auto& names : orientationNames()) {
    std::vector<std::string> found;
    for (const std::string& name : names) {
      if (const auto column = find(name); column != table.header().end()) found.push_back(*column);
    }
    if (found.size() < names.size()) continue;
    throw FileError(
        table.file(), 1,
        fmt::format("columns {} are not read, expected the orientation as a quaternion in qx, qy, qz, qw", fmt::join(found, ", ")));
  }
}

std::string hintOfJointColumns(const CsvTable& table, const Arm* arm) {
  for (const std::string& column : table.header()) {
    if (isNumberedJoint(column, 1)) return fmt::format("; rename '{}' to q1 and so on", column);
  }
  if (arm == nullptr) return "";
  for (std::size_t k = 0; k < arm->joints.size(); ++k) {
    for (const std::string& column : table.header()) {
      if (isJointName(column, arm->joints[k])) return fmt::format("; rename '{}' to q{} and so on", column, k + 1);
    }
  }
  return "";
}

}  // namespace poecal
