// The page: template, style, program, library and data put together.
#include <map>

#include <nlohmann/json.hpp>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/report/report.hpp"
#include "report/page_assets.hpp"
#include "report/sample_pictures.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = 4'800'000;  // of the page

/// JSON that stands in a script element: nothing in it can end that, or be taken for the end of a line.
std::string inScript(const std::string& json) {
  std::string text;
  text.reserve(json.size() + json.size() / 16);
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
    const bool line_end = json.compare(k, 3, "\xE2\x80\xA8") == 0 || json.compare(k, 3, "\xE2\x80\xA9") == 0;
    if (c == '<') {
      text += "\\u003c";
    } else if (c == '>') {
      text += "\\u003e";
    } else if (c == '&') {
      text += "\\u0026";
    } else if (line_end) {
      text += json[k + 2] == '\xA8' ? "\\u2028" : "\\u2029";
      k += 2;
    } else {
      text += c;
    }
  }
  return text;
}

/// `html` with each {{name}} replaced, once, so that nothing in a part is taken for a place of another.
std::string filled(std::string_view html, const std::map<std::string, std::string_view, std::less<>>& parts) {
  std::string text;
  for (std::size_t at = 0; at < html.size();) {
    const std::size_t open = html.find("{{", at), close = open == std::string_view::npos ? open : html.find("}}", open);
    if (close == std::string_view::npos) return text.append(html.substr(at));
    text.append(html.substr(at, open - at));
    text.append(parts.at(std::string(html.substr(open + 2, close - open - 2))));
    at = close + 2;
  }
  return text;
}

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

void writePage(const std::string& json, const std::string& pictures, const std::filesystem::path& out, int jobs) {
  writeTextFile(out / "report.html", reportHtml(json, folderOf(pictures, out), jobs));
}

constexpr const char* kNotBuilt =
    "this build has no library to draw the page with (D3): apps/install-dependencies.sh installs it, then build again";

}  // namespace

bool reportBuilt() { return !pageAssets().d3.empty(); }

void requireReport() {
  if (!reportBuilt()) throw InvalidArgument(kNotBuilt);
}

std::string reportHtml(const std::string& json, const std::filesystem::path& pictures, int jobs) {
  requireReport();
  const PageAssets& assets = pageAssets();
  const std::string data = inScript(json);
  const std::size_t fixed = assets.html.size() + assets.style.size() + assets.program.size() + assets.d3.size() + data.size();
  const std::size_t left = kMostBytes > fixed ? kMostBytes - fixed : 0;
  const std::string shown = inScript(samplePictures(Json::parse(json), pictures, left, jobs));
  return filled(assets.html, {{"style", assets.style},
                              {"program", assets.program},
                              {"d3", assets.d3},
                              {"licence", assets.licence},
                              {"data", data},
                              {"pictures", shown}});
}

void writeReportData(const CalibrationRun& run, const std::filesystem::path& capture, const std::filesystem::path& out) {
  if (run.calibration.identification) writeTextFile(out / "report.json", reportJson(run, noted(capture, out)));
}

std::string writeReport(const CalibrationRun& run, const std::filesystem::path& capture, const std::filesystem::path& out, int jobs) {
  if (!run.calibration.identification) return "the arm was not identified";
  const std::string pictures = noted(capture, out);
  const std::string json = reportJson(run, pictures);
  writeTextFile(out / "report.json", json);
  if (!reportBuilt()) return kNotBuilt;
  writePage(json, pictures, out, jobs);
  return "";
}

void renderReport(const std::filesystem::path& out, int jobs) {
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
    writePage(text, report.at("pictures").get<std::string>(), out, jobs);
  } catch (const Json::exception& problem) {
    throw FileError(file, 0, std::string("is not as it was written: ") + problem.what());
  }
}

}  // namespace poecal
