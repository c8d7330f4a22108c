#include "poecal/calibration/fleet.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/csv.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

std::string cell(const std::optional<long>& count) { return count ? std::to_string(*count) : ""; }
std::string cell(const std::optional<double>& number) { return number ? formatNumber(*number) : ""; }

void addErrors(const StageErrors* errors, std::vector<std::string>& row) {
  row.push_back(errors != nullptr ? cell(errors->rms_px) : "");
  row.push_back(errors != nullptr ? cell(errors->position) : "");
  row.push_back(errors != nullptr ? cell(errors->rotation) : "");
}

std::string joined(const std::vector<FindingSummary>& findings, std::string FindingSummary::*member) {
  std::vector<std::string> texts;
  for (const FindingSummary& finding : findings) texts.push_back(finding.*member);
  return fmt::format("{}", fmt::join(texts, "; "));
}

std::string figure(const std::optional<double>& number) { return number ? fmt::format("{:.3f}", *number) : "-"; }

std::string picturesText(const ResultSummary& summary) {
  if (!summary.pictures || !summary.pictures_with_corners) return "-";
  return fmt::format("{}/{}", *summary.pictures_with_corners, *summary.pictures);
}

std::string diagnosisText(const ResultSummary& summary) {
  if (!summary.verdict) return "-";
  if (!summary.why.empty()) return *summary.verdict;
  if (summary.findings.empty()) return summary.isUnexplained() ? "a gap, no cause found" : "nothing";
  std::vector<std::string> texts;
  for (const FindingSummary& finding : summary.findings) {
    texts.push_back(fmt::format("{} at {} ({})", finding.effect, finding.location, finding.size));
  }
  std::string text = fmt::format("{}", fmt::join(texts, "; "));
  if (summary.shrinkage) text += fmt::format("; gap shrinks by {:.0f} %", 100.0 * *summary.shrinkage);
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

std::vector<std::string> fleetRow(const ResultSummary& summary) {
  std::vector<std::string> row{summary.name,
                               summary.folder.generic_string(),
                               cell(summary.pictures),
                               cell(summary.pictures_with_corners),
                               cell(summary.pictures_left_out),
                               cell(summary.registration_px),
                               cell(summary.free_pose_px),
                               cell(summary.poses)};
  for (const char* stage : {"nominal", "registered", "identified"}) addErrors(summary.stage(stage), row);
  row.push_back(summary.verdict.value_or(""));
  row.push_back(joined(summary.findings, &FindingSummary::effect));
  row.push_back(joined(summary.findings, &FindingSummary::location));
  row.push_back(joined(summary.findings, &FindingSummary::size));
  addErrors(summary.diagnosed ? &*summary.diagnosed : nullptr, row);
  for (const auto& share : {summary.shrinkage, summary.shrinkage_low, summary.shrinkage_high}) row.push_back(cell(share));
  row.push_back(cell(summary.bad_samples));
  row.push_back(fmt::format("{}", fmt::join(summary.warnings, "; ")));
  return row;
}

std::string fleetCsv(const std::vector<ResultSummary>& results) {
  CsvWriter csv(fleetColumns());
  for (const ResultSummary& summary : results) {
    for (const std::string& text : fleetRow(summary)) csv.cell(text);
    csv.endRow();
  }
  return csv.str();
}

std::string fleetText(const std::vector<ResultSummary>& results) {
  constexpr const char* kRow = "{:<{}}  {:>11}  {:>8}  {:>10}  {:>10}  {:>8}  {:>8}  {}\n";
  std::size_t width = 4;
  for (const ResultSummary& summary : results) width = std::max(width, summary.name.size());
  // The figures are in px but for the millimetres of the identified arm.
  std::string text = fmt::format("{:<{}}  {:>11}  {:>8}  {:>10}  {:>10}\n", "", width, "", "nominal", "registered", "identified");
  text += fmt::format(kRow, "name", width, "pictures", "px", "px", "px", "mm", "warnings", "diagnosis");
  for (const ResultSummary& summary : results) {
    const auto errors = [&summary](const char* stage, std::optional<double> StageErrors::*member) {
      const StageErrors* found = summary.stage(stage);
      return figure(found != nullptr ? found->*member : std::nullopt);
    };
    text += fmt::format(kRow, summary.name, width, picturesText(summary), errors("nominal", &StageErrors::rms_px),
                        errors("registered", &StageErrors::rms_px), errors("identified", &StageErrors::rms_px),
                        errors("identified", &StageErrors::position), summary.warnings.size(), diagnosisText(summary));
  }
  return text;
}

}  // namespace poecal
