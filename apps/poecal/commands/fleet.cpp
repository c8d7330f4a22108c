// poecal fleet: the results of many captures in one table.
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/calibration/fleet.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/report/fleet_page.hpp"
#include "poecal/report/report.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal fleet results/* --out fleet.csv
                        nominal  registered  identified
  name       pictures        px          px          px        mm  warnings  diagnosis
  cell-1        60/60     2.996       3.124       0.005     0.001         0  nothing
  cell-2        80/80     3.151       3.150       0.179     0.051         0  joint_coupling at joint:6 (ratio 0.0009735, source 5); gap shrinks by 72 %
  cell-3        80/80     3.414       3.190       0.204     0.174         0  joint_backlash at joint:2 (half_gap 0.0003213 rad); gap shrinks by 79 %
  cell-4        80/80         -           -           -         -         0  -
  4 captures in fleet.csv
The figures are on held-out poses; of cell-4 only `measure` was run.
)";

template <typename Value>
nlohmann::json orNull(const std::optional<Value>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

void addErrors(const std::string& stage, const StageErrors* errors, nlohmann::json& row) {
  row[stage + "_px"] = errors != nullptr ? orNull(errors->rms_px) : nlohmann::json(nullptr);
  row[stage + "_mm"] = errors != nullptr ? orNull(errors->position) : nlohmann::json(nullptr);
  row[stage + "_mrad"] = errors != nullptr ? orNull(errors->rotation) : nlohmann::json(nullptr);
}

/// A row of fleet.csv, by the names of its columns, with numbers and lists as such.
nlohmann::json rowJson(const ResultSummary& summary) {
  nlohmann::json row{{"name", summary.name},
                     {"folder", summary.folder.generic_string()},
                     {"pictures", orNull(summary.pictures)},
                     {"pictures_with_corners", orNull(summary.pictures_with_corners)},
                     {"pictures_left_out", orNull(summary.pictures_left_out)},
                     {"registration_px", orNull(summary.registration_px)},
                     {"free_pose_px", orNull(summary.free_pose_px)},
                     {"poses", orNull(summary.poses)},
                     {"verdict", orNull(summary.verdict)},
                     {"shrinkage", orNull(summary.shrinkage)},
                     {"shrinkage_low", orNull(summary.shrinkage_low)},
                     {"shrinkage_high", orNull(summary.shrinkage_high)},
                     {"bad_samples", orNull(summary.bad_samples)},
                     {"warnings", summary.warnings}};
  for (const char* stage : {"nominal", "registered", "identified"}) addErrors(stage, summary.stage(stage), row);
  addErrors("diagnosed", summary.diagnosed ? &*summary.diagnosed : nullptr, row);
  for (const char* list : {"findings", "locations", "sizes"}) row[list] = nullptr;
  if (!summary.verdict || !summary.why.empty()) return row;
  for (const char* list : {"findings", "locations", "sizes"}) row[list] = nlohmann::json::array();
  for (const FindingSummary& finding : summary.findings) {
    row["findings"].push_back(finding.effect);
    row["locations"].push_back(finding.location);
    row["sizes"].push_back(finding.size);
  }
  return row;
}

constexpr const char* kNoResults = "holds no results, expected a folder that run, or one of its steps, wrote";

/// A run that failed leaves nothing, or what it found before: a row among others. @return a warning of each such folder.
/// @throws FileError where no folder has results, or one holds something else.
std::vector<std::string> requireResults(const std::vector<ResultSummary>& results) {
  std::vector<std::string> failed;
  for (const ResultSummary& summary : results) {
    if (summary.pictures || summary.poses || summary.verdict) continue;
    std::error_code status;
    const auto has = [&](const char* name) { return std::filesystem::exists(summary.folder / name, status); };
    const bool failed_there = std::filesystem::is_empty(summary.folder, status) || (has(".stages") && !has("capture.yaml"));
    if (!failed_there) throw FileError(summary.folder, 0, kNoResults);
    failed.push_back(fmt::format("{}: {}", summary.folder.string(), kNoResults));
  }
  if (failed.size() == results.size()) throw FileError(results.front().folder, 0, kNoResults);
  return failed;
}

std::vector<std::string> namedTwice(const std::vector<std::filesystem::path>& folders) {
  std::set<std::filesystem::path> seen;
  std::vector<std::string> remarks;
  for (const std::filesystem::path& folder : folders) {
    if (!seen.insert(std::filesystem::weakly_canonical(folder / "")).second) {
      remarks.push_back(fmt::format("{} is named twice, expected each folder once", folder.string()));
    }
  }
  return remarks;
}

}  // namespace

std::function<int()> setUpFleet(CLI::App& app, const Common& common) {
  struct Options {
    std::vector<std::filesystem::path> folders;
    std::filesystem::path out, page;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("OUT", options->folders, "Folders that `run`, or its steps, wrote: one for each capture")->required();
  app.add_option("--out", options->out, "The table to write (fleet.csv)")->required();
  app.add_option("--page", options->page, "A page with a small picture of every capture to write too (fleet.html)");
  app.footer(kExample);
  return [options, &common] {
    std::vector<std::filesystem::path> inputs;
    for (const std::filesystem::path& folder : options->folders) {
      for (const char* name : {"registration.yaml", "identification.json", "diagnosis.json", "model.yaml", "camera.yaml", "detections.csv",
                               "flange_poses.csv"}) {
        inputs.push_back(folder / name);
      }
      for (const std::filesystem::path& file : reportFiles(folder)) inputs.push_back(file);
    }
    std::vector<std::filesystem::path> outputs{options->out};
    if (!options->page.empty()) {
      requireReport();
      outputs.push_back(options->page);
    }
    requireOutputs(outputs, inputs);
    TerminalListener(common).warnings(namedTwice(options->folders));
    std::vector<ResultSummary> results;
    nlohmann::json captures = nlohmann::json::array();
    for (const std::filesystem::path& folder : options->folders) {
      results.push_back(readResults(folder));
      captures.push_back(rowJson(results.back()));
    }
    TerminalListener(common).warnings(requireResults(results));
    writeTextFile(options->out, fleetCsv(results));
    std::string text = fleetText(results) + fmt::format("{} captures in {}", results.size(), options->out.string());
    nlohmann::json json{{"captures", captures}, {"file", options->out.string()}};
    if (!options->page.empty()) {
      writeTextFile(options->page, fleetHtml(results, options->page));
      text += ", to look at: " + options->page.string();
      json["page"] = options->page.string();
    }
    printSummary(common, text + "\n", json);
    return 0;
  };
}

}  // namespace poecal::app
