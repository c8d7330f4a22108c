#include "fleet.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/yaml.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"

namespace poecal::app {
namespace {

using Json = FleetRow;

/// A result file of a folder, where it is there. JSON is YAML.
std::optional<YamlNode> readResult(const std::filesystem::path& file, const char* format) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  YamlNode root = YamlNode::load(file);
  root.checkFormat(format);
  return root;
}

Json numberOrNull(const YamlNode& node, const char* key) {
  const auto value = node.find(key);
  return value ? Json(value->number()) : Json(nullptr);
}

Json countOrNull(const YamlNode& node, const char* key) {
  const auto value = node.find(key);
  return value ? Json(value->integer()) : Json(nullptr);
}

Json textsOf(const YamlNode& list) {
  Json texts = Json::array();
  for (const YamlNode& item : list.items()) texts.push_back(item.text());
  return texts;
}

void readRegistration(const YamlNode& root, Json& row) {
  for (const char* key : {"pictures", "pictures_with_corners", "pictures_left_out"}) row[key] = countOrNull(root, key);
  row["registration_px"] = root["rms_px"].number();
  row["free_pose_px"] = root["free_rms_px"].number();
}

void readIdentification(const YamlNode& root, Json& row) {
  row["poses"] = root["poses"].integer();
  const bool any_held_out = root["held_out"]["poses"].integer() > 0;
  for (const YamlNode& stage : root["stages"].items()) {
    if (!any_held_out) break;
    const std::string name = stage["stage"].text();
    const YamlNode held_out = stage["held_out"];
    row[name + "_px"] = numberOrNull(held_out, "rms_px");
    row[name + "_mm"] = numberOrNull(held_out["position_mm"], "mean");
    row[name + "_mrad"] = numberOrNull(held_out["rotation_mrad"], "mean");
  }
  for (const Json& warning : textsOf(root["warnings"])) row["warnings"].push_back(warning);
}

/// "half_gap 0.0003 rad, source 5"
std::string sizeOf(const YamlNode& finding) {
  const YamlNode parameters = finding["parameters"], units = finding["units"];
  std::vector<std::string> sizes;
  for (const std::string& name : parameters.keys()) {
    const auto value = parameters.find(name.c_str());
    const auto unit = units.find(name.c_str());
    if (!value) continue;
    sizes.push_back(fmt::format("{} {:.4g}{}", name, value->number(), unit && !unit->text().empty() ? " " + unit->text() : ""));
  }
  return fmt::format("{}", fmt::join(sizes, ", "));
}

void readDiagnosis(const YamlNode& root, Json& row) {
  row["verdict"] = root["verdict"].text();
  if (const auto why = root.find("why")) {
    row["warnings"].push_back(why->text());
    return;
  }
  for (const char* column : {"findings", "locations", "sizes"}) row[column] = Json::array();
  for (const YamlNode& finding : root["findings"].items()) {
    row["findings"].push_back(finding["effect"].text());
    row["locations"].push_back(finding["location"].text());
    row["sizes"].push_back(sizeOf(finding));
  }
  const YamlNode gap = root["gap"];
  const std::vector<YamlNode> stages = gap["stages"].items();
  if (!stages.empty()) {
    row["diagnosed_px"] = numberOrNull(stages.back(), "rms_px");
    row["diagnosed_mm"] = numberOrNull(stages.back(), "position_mm");
    row["diagnosed_mrad"] = numberOrNull(stages.back(), "rotation_mrad");
  }
  if (gap["shrinkage_claimed"].text() == "true") {
    const Eigen::VectorXd interval = gap["shrinkage_ci95"].vector(2);
    row["shrinkage"] = gap["shrinkage"].number();
    row["shrinkage_low"] = interval(0);
    row["shrinkage_high"] = interval(1);
  }
  row["bad_samples"] = root["bad_samples"].items().size();
  if (root["remaining"]["significant"].text() == "true") row["warnings"].push_back("structure remains that no finding explains");
}

/// A list as its entries joined by `separator`, null as nothing.
std::string cellText(const Json& cell, const char* separator) {
  if (cell.is_null()) return "";
  if (cell.is_string()) return cell.get<std::string>();
  if (cell.is_array()) return fmt::format("{}", fmt::join(cell.get<std::vector<std::string>>(), separator));
  return cell.dump();
}

std::string figure(const Json& cell) { return cell.is_null() ? "-" : fmt::format("{:.3f}", cell.get<double>()); }

std::string picturesText(const Json& row) {
  if (row["pictures"].is_null()) return "-";
  return fmt::format("{}/{}", row["pictures_with_corners"].get<int>(), row["pictures"].get<int>());
}

std::string diagnosisText(const Json& row) {
  if (row["verdict"].is_null()) return "-";
  const Json& findings = row["findings"];
  if (findings.is_null()) return row["verdict"].get<std::string>();
  if (findings.empty()) return "nothing";
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < findings.size(); ++k) {
    texts.push_back(fmt::format("{} at {} ({})", findings[k].get<std::string>(), row["locations"][k].get<std::string>(),
                                row["sizes"][k].get<std::string>()));
  }
  std::string text = fmt::format("{}", fmt::join(texts, "; "));
  if (!row["shrinkage"].is_null()) text += fmt::format("; gap shrinks by {:.0f} %", 100.0 * row["shrinkage"].get<double>());
  return text;
}

}  // namespace

const std::vector<std::string>& fleetColumns() {
  static const std::vector<std::string> kColumns{"name",
                                                 "folder",
                                                 "pictures",
                                                 "pictures_with_corners",
                                                 "pictures_left_out",
                                                 "registration_px",
                                                 "free_pose_px",
                                                 "poses",
                                                 "nominal_px",
                                                 "nominal_mm",
                                                 "nominal_mrad",
                                                 "registered_px",
                                                 "registered_mm",
                                                 "registered_mrad",
                                                 "identified_px",
                                                 "identified_mm",
                                                 "identified_mrad",
                                                 "verdict",
                                                 "findings",
                                                 "locations",
                                                 "sizes",
                                                 "diagnosed_px",
                                                 "diagnosed_mm",
                                                 "diagnosed_mrad",
                                                 "shrinkage",
                                                 "shrinkage_low",
                                                 "shrinkage_high",
                                                 "bad_samples",
                                                 "warnings"};
  return kColumns;
}

FleetRow readFleetRow(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) throw FileError(folder, 0, "no such folder, expected one with the results of a capture");
  FleetRow row;
  for (const std::string& column : fleetColumns()) row[column] = nullptr;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(folder);
  row["name"] = whole.filename().string();
  row["folder"] = folder.generic_string();
  row["warnings"] = Json::array();
  if (const auto root = readResult(folder / "registration.yaml", "poecal-registration/1")) readRegistration(*root, row);
  if (const auto root = readResult(folder / "identification.json", "poecal-identification/1")) readIdentification(*root, row);
  if (const auto root = readResult(folder / "diagnosis.json", "poecal-diagnosis/1")) readDiagnosis(*root, row);
  return row;
}

std::string fleetCsv(const std::vector<FleetRow>& rows) {
  CsvWriter csv(fleetColumns());
  for (const FleetRow& row : rows) {
    for (const std::string& column : fleetColumns()) {
      const Json& cell = row[column];
      if (cell.is_number_float()) {
        csv.cell(cell.get<double>());
      } else {
        csv.cell(cellText(cell, "; "));
      }
    }
    csv.endRow();
  }
  return csv.str();
}

std::string fleetText(const std::vector<FleetRow>& rows) {
  constexpr const char* kRow = "{:<{}}  {:>11}  {:>8}  {:>10}  {:>10}  {:>8}  {:>8}  {}\n";
  std::size_t width = 4;
  for (const FleetRow& row : rows) width = std::max(width, row["name"].get<std::string>().size());
  // The figures are in px but for the millimetres of the identified arm.
  std::string text = fmt::format("{:<{}}  {:>11}  {:>8}  {:>10}  {:>10}\n", "", width, "", "nominal", "registered", "identified");
  text += fmt::format(kRow, "name", width, "pictures", "px", "px", "px", "mm", "warnings", "diagnosis");
  for (const FleetRow& row : rows) {
    text +=
        fmt::format(kRow, row["name"].get<std::string>(), width, picturesText(row), figure(row["nominal_px"]), figure(row["registered_px"]),
                    figure(row["identified_px"]), figure(row["identified_mm"]), row["warnings"].size(), diagnosisText(row));
  }
  return text;
}

}  // namespace poecal::app
