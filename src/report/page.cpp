// The page of a calibration, and its files.
#include <nlohmann/json.hpp>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/report/report.hpp"
#include "report/page_assets.hpp"
#include "report/page_text.hpp"
#include "report/report_json.hpp"
#include "report/sample_pictures.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = 4'800'000;  // of the page

/// The folder of the pictures as it is noted down: relative to OUT where that leads there.
std::string noted(const std::filesystem::path& capture, const std::filesystem::path& out) {
  if (capture.empty()) return "";
  std::error_code status;
  const std::filesystem::path there = std::filesystem::weakly_canonical(capture, status),
                              here = std::filesystem::weakly_canonical(out, status);
  return status ? "" : there.lexically_proximate(here).generic_string();
}

std::filesystem::path folderOf(const std::string& pictures, const std::filesystem::path& out) {
  return pictures.empty() ? std::filesystem::path() : out / std::filesystem::path(pictures);
}

/// @param json  text of `report`.
std::string pageOf(const Json& report, const std::string& json, const std::filesystem::path& pictures, int jobs,
                   const std::filesystem::path& kept, const ProgressFunction& progress) {
  const PageAssets& assets = pageAssets();
  const std::string data = inScript(json);
  const std::size_t fixed = assets.html.size() + assets.style.size() + assets.program.size() + assets.d3.size() + data.size();
  const std::size_t left = kMostBytes > fixed ? kMostBytes - fixed : 0;
  return pageText(assets.program, data, inScript(samplePictures(report, pictures, left, jobs, kept, progress)));
}

void writePage(const Json& report, const std::string& json, const std::filesystem::path& out, int jobs, const ProgressFunction& progress) {
  const std::filesystem::path pictures = folderOf(report.at("pictures").get<std::string>(), out);
  writeTextFile(out / "report.html", pageOf(report, json, pictures, jobs, out / ".stages" / "report-pictures", progress));
}

constexpr const char* kNotBuilt =
    "this build has no library to draw the page with (D3): apps/install-dependencies.sh installs it, then build again";

}  // namespace

bool reportBuilt() { return !pageAssets().d3.empty(); }

void requireReport() {
  if (!reportBuilt()) throw InvalidArgument(kNotBuilt);
}

std::string reportHtml(const std::string& json, const std::filesystem::path& pictures, int jobs, const std::filesystem::path& kept,
                       const ProgressFunction& progress) {
  requireReport();
  return pageOf(Json::parse(json), json, pictures, jobs, kept, progress);
}

void writeReportData(const CalibrationRun& run, const std::filesystem::path& capture, const std::filesystem::path& out) {
  if (run.calibration.identification) writeTextFile(out / "report.json", reportJson(run, noted(capture, out)));
}

std::string writeReport(const CalibrationRun& run, const std::filesystem::path& capture, const std::filesystem::path& out, int jobs,
                        const ProgressFunction& progress) {
  if (!run.calibration.identification) return "the arm was not identified";
  const Json report = reportObject(run, noted(capture, out));
  const std::string json = reportText(report);
  writeTextFile(out / "report.json", json);
  if (!reportBuilt()) return kNotBuilt;
  writePage(report, json, out, jobs, progress);
  return "";
}

void renderReport(const std::filesystem::path& out, int jobs, const ProgressFunction& progress) {
  requireReport();
  const std::filesystem::path file = out / "report.json";
  std::error_code status;
  if (!std::filesystem::exists(file, status)) {
    throw FileError(file, 0, "there is none, expected the results of poecal run, identify or diagnose");
  }
  const std::string text = readUtf8File(file);
  const Json report = Json::parse(text, nullptr, false);
  if (report.is_discarded() || !report.is_object() || report.value("format", Json()) != "poecal-report/1") {
    throw FileError(file, 0, "is no report, expected format poecal-report/1 as poecal run, identify and diagnose write it");
  }
  try {
    writePage(report, text, out, jobs, progress);
  } catch (const Json::exception& problem) {
    throw FileError(file, 0, std::string("is not as it was written: ") + problem.what());
  }
}

}  // namespace poecal
