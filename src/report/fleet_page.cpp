#include "poecal/report/fleet_page.hpp"

#include <nlohmann/json.hpp>

#include "poecal/report/report.hpp"
#include "report/page_assets.hpp"
#include "report/page_text.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

template <typename Value>
Json orNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json stageJson(const StageErrors& errors) {
  return {{"stage", errors.stage}, {"px", orNull(errors.rms_px)}, {"mm", orNull(errors.position)}, {"mrad", orNull(errors.rotation)}};
}

/// The report of a capture from the folder of the page, or null.
Json linkTo(const std::filesystem::path& folder, const std::filesystem::path& page) {
  std::error_code status;
  const std::filesystem::path report = folder / "report.html";
  if (!std::filesystem::exists(report, status)) return nullptr;
  const std::filesystem::path from = std::filesystem::weakly_canonical(page, status).parent_path();
  return std::filesystem::weakly_canonical(report, status).lexically_proximate(from).generic_string();
}

Json cellJson(const ResultSummary& summary, const std::filesystem::path& page) {
  Json stages = Json::array(), findings = Json::array();
  for (const StageErrors& stage : summary.stages) stages.push_back(stageJson(stage));
  for (const FindingSummary& finding : summary.findings) {
    findings.push_back({{"effect", finding.effect}, {"location", finding.location}, {"size", finding.size}});
  }
  return {{"name", summary.name},
          {"report", linkTo(summary.folder, page)},
          {"poses", orNull(summary.poses)},
          {"free_pose_px", orNull(summary.free_pose_px)},
          {"stages", stages},
          {"diagnosed", summary.diagnosed ? stageJson(*summary.diagnosed) : Json(nullptr)},
          {"verdict", orNull(summary.verdict)},
          {"why", summary.why},
          {"findings", findings},
          {"structure_left", summary.isUnexplained()},
          {"shrinkage", {orNull(summary.shrinkage), orNull(summary.shrinkage_low), orNull(summary.shrinkage_high)}},
          {"bad_samples", orNull(summary.bad_samples)},
          {"warnings", summary.warnings}};
}

}  // namespace

std::string fleetHtml(const std::vector<ResultSummary>& results, const std::filesystem::path& page) {
  requireReport();
  Json cells = Json::array();
  for (const ResultSummary& summary : results) cells.push_back(cellJson(summary, page));
  return pageText(pageAssets().fleet, inScript(Json{{"cells", cells}}.dump()), "null");
}

}  // namespace poecal
