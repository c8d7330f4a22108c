#include "target/target_yaml.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "geometry/pose_yaml.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/geometry/se3.hpp"
#include "target/names.hpp"

namespace poecal {
namespace {

/// Runs `make` and gives what it has to say about a value the place in the file.
template <typename Make>
auto at(const YamlNode& node, const Make& make) {
  try {
    return make();
  } catch (const InvalidArgument& error) {
    node.fail(error.what());
  }
}

/// The id of an entry of a list, which must not have come before.
int freshId(const YamlNode& entry, std::set<int>& seen) {
  const YamlNode node = entry["id"];
  const int id = node.integer();
  if (!seen.insert(id).second) node.fail(fmt::format("id {} is there twice, expected each once", id));
  return id;
}

std::string readFamily(const YamlNode& node) {
  return at(node, [&] { return std::string(findIdSet(tagFamilies(), node.text(), "tag family").name); });
}

Target parseTags(const YamlNode& node) {
  node.checkKeys({"type", "family", "tags"});
  const std::string family = readFamily(node["family"]);
  const YamlNode list = node["tags"];
  const std::vector<YamlNode> entries = list.items();
  std::vector<TargetTag> tags;
  std::set<int> seen;
  for (const YamlNode& entry : entries) {
    entry.checkKeys({"id", "size", "center", "quaternion_xyzw"});
    TargetTag tag;
    tag.id = freshId(entry, seen);
    tag.size = entry["size"].positive();
    // Alone, a tag is the target's frame unless said otherwise; of several, each must say where it is.
    const bool centre_needed = entries.size() > 1;
    const Eigen::Vector3d centre =
        centre_needed || entry.has("center") ? entry["center"].vector3() : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const auto quaternion = entry.find("quaternion_xyzw");
    tag.T_target_tag =
        quaternion ? poseFromQuaternion(centre, readUnitQuaternion(*quaternion)) : Eigen::Isometry3d(Eigen::Translation3d(centre));
    tags.push_back(tag);
    // One by one, so that a bad tag is named with its own line.
    at(entry, [&] { return apriltagTarget(family, {tag}); });
  }
  return at(list, [&] { return apriltagTarget(family, tags); });
}

Target parsePoints(const YamlNode& node) {
  node.checkKeys({"type", "points"});
  const YamlNode list = node["points"];
  std::vector<TargetPoint> points;
  std::set<int> seen;
  for (const YamlNode& entry : list.items()) {
    entry.checkKeys({"id", "position"});
    points.push_back({{freshId(entry, seen), 0}, entry["position"].vector3()});
  }
  return at(list, [&] { return pointsTarget(points); });
}

/// An aprilgrid's own keys are Kalibr's; `type_key` tells which of the two writes the type.
Target parseAprilgrid(const YamlNode& node, const char* type_key) {
  node.checkKeys({type_key, "family", "tagCols", "tagRows", "tagSize", "tagSpacing", "firstId", "codeOffset", "borderBits"});
  // Kalibr's own files name no family: its grids are always tag36h11.
  const auto family = node.find("family");
  const auto first_id = node.find("firstId"), code_offset = node.find("codeOffset");
  if (first_id && code_offset) code_offset->fail("stands beside firstId, expected one of them");
  const auto border = node.find("borderBits");
  const int border_bits = border ? border->integer() : 0;
  if (border && (border_bits < 1 || border_bits > 2)) border->fail(fmt::format("is {}, expected 1 or 2", border_bits));
  return at(node, [&] {
    return aprilgridTarget(family ? readFamily(*family) : "tag36h11", node["tagCols"].integer(), node["tagRows"].integer(),
                           node["tagSize"].positive(), node["tagSpacing"].positive(),
                           first_id      ? first_id->integer()
                           : code_offset ? code_offset->integer()
                                         : 0,
                           border_bits);
  });
}

Target parseKalibrCheckerboard(const YamlNode& node) {
  node.checkKeys({"target_type", "targetCols", "targetRows", "rowSpacingMeters", "colSpacingMeters"});
  const double square = node["colSpacingMeters"].positive();
  const YamlNode rows = node["rowSpacingMeters"];
  constexpr double kSame = 1e-6;  // relative; a typing error is more
  if (!(std::abs(rows.positive() - square) <= kSame * square)) {
    rows.fail(fmt::format("is {} and colSpacingMeters {}, expected squares", formatNumber(rows.positive()), formatNumber(square)));
  }
  return at(node, [&] { return chessboardTarget(node["targetCols"].integer(), node["targetRows"].integer(), square); });
}

Target parseKalibrTarget(const YamlNode& node) {
  const YamlNode type = node["target_type"];
  const std::string name = type.text();
  if (name == "aprilgrid") return parseAprilgrid(node, "target_type");
  if (name == "checkerboard") return parseKalibrCheckerboard(node);
  type.fail(fmt::format("is '{}', expected aprilgrid or checkerboard", name));
}

Target parseCharuco(const YamlNode& node) {
  node.checkKeys({"type", "cols", "rows", "square", "marker", "dictionary"});
  const YamlNode dictionary = node["dictionary"];
  at(dictionary, [&] { return findIdSet(markerDictionaries(), dictionary.text(), "dictionary"); });
  return at(node, [&] {
    return charucoTarget(node["cols"].integer(), node["rows"].integer(), node["square"].positive(), node["marker"].positive(),
                         dictionary.text());
  });
}

Target parseChessboard(const YamlNode& node) {
  node.checkKeys({"type", "cols", "rows", "square"});
  return at(node, [&] { return chessboardTarget(node["cols"].integer(), node["rows"].integer(), node["square"].positive()); });
}

std::string tagYaml(const TargetTag& tag) {
  std::string text =
      fmt::format("{{id: {}, size: {}, center: {}", tag.id, formatNumber(tag.size), yamlVector(tag.T_target_tag.translation()));
  if (tag.T_target_tag.linear() != Eigen::Matrix3d::Identity()) {
    text += ", quaternion_xyzw: " + yamlVector(quaternionXyzw(tag.T_target_tag));
  }
  return text + "}";
}

std::vector<std::string> yamlLines(const Target& target) {
  std::vector<std::string> lines;
  switch (target.type) {
    case TargetType::kAprilTag:
      lines = {"type: apriltag", "family: " + target.family, "tags:"};
      for (const TargetTag& tag : target.tags) lines.push_back("  - " + tagYaml(tag));
      break;
    case TargetType::kPoints:
      lines = {"type: points", "points:"};
      for (const TargetPoint& point : target.points) {
        lines.push_back(fmt::format("  - {{id: {}, position: {}}}", point.id.tag, yamlVector(point.p_target)));
      }
      break;
    case TargetType::kAprilGrid:
      lines = {"type: aprilgrid",
               "family: " + target.family,
               fmt::format("tagCols: {}", target.cols),
               fmt::format("tagRows: {}", target.rows),
               "tagSize: " + formatNumber(target.tags.front().size),
               "tagSpacing: " + formatNumber(target.tag_spacing),
               fmt::format("firstId: {}", target.first_id)};
      if (target.border_bits > 0) lines.push_back(fmt::format("borderBits: {}", target.border_bits));
      break;
    case TargetType::kCharuco:
      lines = {"type: charuco",
               fmt::format("cols: {}", target.cols),
               fmt::format("rows: {}", target.rows),
               "square: " + formatNumber(target.square),
               "marker: " + formatNumber(target.marker),
               "dictionary: " + target.dictionary};
      break;
    case TargetType::kChessboard:
      lines = {"type: chessboard", fmt::format("cols: {}", target.cols), fmt::format("rows: {}", target.rows),
               "square: " + formatNumber(target.square)};
      break;
  }
  return lines;
}

}  // namespace

Target parseTarget(const YamlNode& node) {
  if (node.has("target_type") && !node.has("type")) return parseKalibrTarget(node);
  const YamlNode type = node["type"];
  const std::string name = type.text();
  if (name == "apriltag") return parseTags(node);
  if (name == "points") return parsePoints(node);
  if (name == "aprilgrid") return parseAprilgrid(node, "type");
  if (name == "charuco") return parseCharuco(node);
  if (name == "chessboard") return parseChessboard(node);
  type.fail(fmt::format("is '{}', expected apriltag, points, aprilgrid, charuco or chessboard", name));
}

std::string targetYamlLines(const Target& target, const std::string& indent) {
  std::string text;
  for (const std::string& line : yamlLines(target)) text += indent + line + "\n";
  return text;
}

Target readTarget(const std::filesystem::path& file) { return parseTarget(YamlNode::load(file)); }

std::string targetYaml(const Target& target) { return targetYamlLines(target, ""); }

}  // namespace poecal
