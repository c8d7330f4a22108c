#include "poecal/calibration/results.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/results_json.hpp"
#include "core/yaml.hpp"
#include "diagnosis/diagnosis_json.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/identification/model.hpp"

namespace poecal {
namespace {

/// A result file of a folder, where it is there. JSON is YAML.
std::optional<YamlNode> readResult(const std::filesystem::path& file, const char* format) {
  std::error_code status;
  if (!std::filesystem::exists(file, status)) return std::nullopt;
  YamlNode root = YamlNode::load(file);
  root.checkFormat(format);
  return root;
}

std::optional<double> findNumber(const YamlNode& node, const char* key) {
  const auto value = node.find(key);
  return value ? std::optional(value->number()) : std::nullopt;
}

std::optional<long> findCount(const YamlNode& node, const char* key) {
  const auto value = node.find(key);
  return value ? std::optional(static_cast<long>(value->integer())) : std::nullopt;
}

void readRegistration(const YamlNode& root, ResultSummary& summary) {
  summary.pictures = findCount(root, "pictures");
  summary.pictures_with_corners = findCount(root, "pictures_with_corners");
  summary.pictures_left_out = findCount(root, "pictures_left_out");
  summary.registration_px = root["rms_px"].number();
  summary.free_pose_px = root["free_rms_px"].number();
}

void readIdentification(const YamlNode& root, ResultSummary& summary) {
  summary.poses = root["poses"].integer();
  const bool any_held_out = root["held_out"]["poses"].integer() > 0;
  for (const YamlNode& stage : root["stages"].items()) {
    if (!any_held_out) break;
    const YamlNode held_out = stage["held_out"];
    summary.stages.push_back({stage["stage"].text(), findNumber(held_out, "rms_px"), findNumber(held_out["position_mm"], "mean"),
                              findNumber(held_out["rotation_mrad"], "mean")});
  }
  summary.arm_beyond_tolerance = findNumber(root, "arm_beyond_tolerance");
  if (const auto noise = root.find("noise")) {
    summary.noise_scale = findNumber(*noise, "scale");
    summary.corner_sigma_px = findNumber(*noise, "sigma_px");
  }
  for (const YamlNode& warning : root["warnings"].items()) summary.warnings.push_back(warning.text());
}

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

void readDiagnosis(const YamlNode& root, ResultSummary& summary) {
  summary.verdict = root["verdict"].text();
  if (const auto why = root.find("why")) {
    summary.why = why->text();
    summary.warnings.push_back(summary.why);
    return;
  }
  for (const YamlNode& finding : root["findings"].items()) {
    FindingSummary& found = summary.findings.emplace_back();
    found = {finding["effect"].text(), finding["location"].text(), sizeOf(finding), finding["driver"].text()};
    found.probability = findNumber(finding, "probability").value_or(1.0);
    if (const auto way = finding.find("separate_with")) found.separate_with = way->text();
    const auto alternatives = finding.find("alternatives");
    for (const YamlNode& other : alternatives ? alternatives->items() : std::vector<YamlNode>{}) {
      found.alternatives.push_back(
          {other["effect"].text(), other["location"].text(), other["driver"].text(), other["probability"].number()});
    }
  }
  if (const auto noise = root.find("noise")) {
    if (const auto sigma = findNumber(*noise, "pixel_sigma")) summary.corner_sigma_px = sigma;
    summary.tag_sigma_px = findNumber(*noise, "tag_sigma_px");
    summary.joint_repeatability = findNumber(*noise, "joint_repeatability");
    if (const auto beyond = findNumber(*noise, "arm_beyond_tolerance")) summary.arm_beyond_tolerance = beyond;
  }
  const YamlNode gap = root["gap"];
  const std::vector<YamlNode> stages = gap["stages"].items();
  if (!stages.empty()) {
    const YamlNode& last = stages.back();
    summary.diagnosed = {last["stage"].text(), findNumber(last, "rms_px"), findNumber(last, "position_mm"),
                         findNumber(last, "rotation_mrad")};
  }
  if (gap["shrinkage_claimed"].text() == "true") {
    const Eigen::VectorXd interval = gap["shrinkage_ci95"].vector(2);
    summary.shrinkage = gap["shrinkage"].number();
    summary.shrinkage_low = interval(0);
    summary.shrinkage_high = interval(1);
  }
  summary.bad_samples = static_cast<long>(root["bad_samples"].items().size());
  for (const YamlNode& bad : root["bad_samples"].items()) {
    if (const auto image = bad.find("image")) summary.bad_images.push_back(image->text());
  }
  const auto gap_remains = root["remaining"].find("gap_remains");
  summary.gap_remains = gap_remains && gap_remains->text() == "true";
  summary.structure_left = root["remaining"]["significant"].text() == "true";
  if (summary.structure_left) summary.warnings.push_back("structure remains that no finding explains");
  if (summary.gap_remains) summary.warnings.push_back("a gap remains that no finding explains");
}

/// The first stages of a diagnosis are the identification's own, with the same numbers.
void requireOneRun(const YamlNode& diagnosis, const ResultSummary& summary) {
  constexpr double kSame = 1e-6;
  if (summary.stages.empty() || !summary.diagnosed) return;
  const YamlNode first = diagnosis["gap"]["stages"].items().front();
  const std::optional<double> here = findNumber(first, "position_mm"), there = summary.stages.front().position;
  if (!here || !there || std::abs(*here - *there) <= kSame * std::max(std::abs(*here), std::abs(*there))) return;
  first.fail(fmt::format("the nominal arm is off by {:.4g} mm, and by {:.4g} mm in identification.json: expected results of one run", *here,
                         *there));
}

}  // namespace

nlohmann::ordered_json diagnosisObject(const Calibration& calibration, const Measurements& measurements) {
  if (!calibration.diagnosis && calibration.no_diagnosis.empty()) throw InvalidArgument("no diagnosis was asked for");
  nlohmann::ordered_json json{{"format", "poecal-diagnosis/1"}, {"verdict", "insufficient data"}, {"why", calibration.no_diagnosis}};
  if (calibration.diagnosis) json = diagnosisObject(*calibration.diagnosis, measurements.samples);
  json["model_source"] = modelSourceName(calibration.model_source);
  json["model_source_why"] = calibration.model_reason;
  return json;
}

std::string diagnosisJson(const Calibration& calibration, const Measurements& measurements) {
  return diagnosisObject(calibration, measurements).dump(2) + "\n";
}

void writeResults(const Calibration& calibration, const Measurements& measurements, const ResultFiles& files,
                  const std::filesystem::path& out) {
  if (files.registration && calibration.registration) {
    writeTextFile(out / "registration.yaml", registrationYaml(calibration, measurements));
    writeTextFile(out / "flange_poses.csv", flangePosesCsv(calibration, measurements));
  }
  if (files.identification && calibration.identification) {
    writeTextFile(out / "identification.json", identificationJson(*calibration.identification, measurements.samples));
  }
  if (files.diagnosis && (calibration.diagnosis || !calibration.no_diagnosis.empty())) {
    writeTextFile(out / "diagnosis.json", diagnosisJson(calibration, measurements));
  }
  if ((files.identification || files.diagnosis) && calibration.model) writeTextFile(out / "model.yaml", modelYaml(*calibration.model));
}

const StageErrors* ResultSummary::stage(const std::string& name_of_stage) const {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const StageErrors& errors) { return errors.stage == name_of_stage; });
  return found == stages.end() ? nullptr : &*found;
}

ResultSummary readResults(const std::filesystem::path& folder) {
  std::error_code status;
  if (!std::filesystem::is_directory(folder, status))
    throw FileError(folder, 0, "no such folder, expected one with the results of a capture");
  ResultSummary summary;
  summary.folder = folder;
  summary.name = std::filesystem::weakly_canonical(folder).filename().string();
  if (const auto root = readResult(folder / "registration.yaml", "poecal-registration/1")) readRegistration(*root, summary);
  if (const auto root = readResult(folder / "identification.json", "poecal-identification/1")) readIdentification(*root, summary);
  if (const auto root = readResult(folder / "diagnosis.json", "poecal-diagnosis/1")) {
    readDiagnosis(*root, summary);
    requireOneRun(*root, summary);
  }
  return summary;
}

}  // namespace poecal
