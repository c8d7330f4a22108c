#include "report/report_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "calibration/results_json.hpp"
#include "identification/identification_json.hpp"
#include "poecal/capture/row_order.hpp"
#include "poecal/report/report.hpp"
#include "report/numbers.hpp"
#include "report/sections.hpp"
#include "report/verdict.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

/// The worst, and of the others every so many-th, in their order.
std::vector<std::size_t> thinned(const std::vector<double>& sizes, std::size_t most) {
  std::vector<std::size_t> all(sizes.size());
  std::iota(all.begin(), all.end(), 0);
  if (all.size() <= most) return all;
  const std::size_t worst = most / 5;
  std::stable_sort(all.begin(), all.end(), [&sizes](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  std::vector<std::size_t> kept(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(worst));
  std::vector<std::size_t> others(all.begin() + static_cast<std::ptrdiff_t>(worst), all.end());
  std::sort(others.begin(), others.end());
  const std::size_t wanted = most - worst;
  for (std::size_t k = 0; k < wanted; ++k) kept.push_back(others[k * others.size() / wanted]);
  std::sort(kept.begin(), kept.end());
  return kept;
}

/// A board has many corners: as many samples as corners allow.
std::size_t mostShown(const Measurements& measurements) {
  constexpr std::size_t kMostCorners = 12000;
  std::size_t corners = 1;
  for (const Observation& observation : measurements.observations) corners = std::max(corners, observation.corners.size());
  return std::clamp<std::size_t>(kMostCorners / corners, 10, kMostReportSamples);
}

void addSizes(const Measurements& measurements, const StageAt& stage, std::vector<Eigen::VectorXd>& residuals, std::vector<double>& sizes) {
  for (const Observation& observation : measurements.observations) {
    residuals.push_back(stage.residual(observation));
    sizes.push_back(residualSize(observation, residuals.back()));
  }
}

void addContexts(ReportSource& source) {
  const Measurements& measured = source.measurements;
  const Cell& cell = source.models.stages[source.models.after].cell;
  const auto capture = makeCaptureContext(cell, measured.target, measured.gravity, measured.samples, measured.other_columns);
  for (const std::size_t k : source.shown) {
    const std::size_t number = measured.observations[k].sample;
    source.contexts.push_back(makeSampleContext(capture, measured.samples[number], number, {}));
  }
}

/// Rows that some step set aside or marked, worst first, by their number among the samples.
Json suspectsJson(const ReportSource& source) {
  std::map<std::size_t, std::string> why;
  for (const SuspectRow& row : source.identification.suspects) why[row.sample] = row.left_out ? "left out" : "outlier";
  if (source.calibration.diagnosis) {
    for (const BadSample& row : source.calibration.diagnosis->bad_samples) why[row.sample] = "belongs to no model";
  }
  Json list = Json::array();
  for (const auto& [sample, reason] : why) list.push_back({{"sample", sample}, {"why", reason}});
  return list;
}

Json countsJson(const ReportSource& source) {
  return {{"samples", source.measurements.samples.size()},
          {"measured", source.measurements.observations.size()},
          {"shown", source.shown.size()},
          {"held_out", source.identification.held_out_poses}};
}

/// Root mean square of what each model leaves of all samples, px or mm.
Json modelsRmsJson(const ReportSource& source) {
  Json list = Json::array();
  for (const StageAt& stage : source.at) {
    double squares = 0.0, points = 0.0;
    for (const Observation& observation : source.measurements.observations) {
      const double count = observation.pose ? 1.0 : static_cast<double>(observation.corners.size());
      squares += count * std::pow(residualSize(observation, stage.residual(observation)), 2);
      points += count;
    }
    const double unit = source.measurements.observations.front().pose ? 1e3 : 1.0;
    list.push_back(rounded(points > 0.0 ? unit * std::sqrt(squares / points) : 0.0));
  }
  return list;
}

Json cameraJson(const ReportSource& source) {
  const std::optional<Camera>& camera = source.models.stages[source.models.after].cell.camera;
  if (!camera) return nullptr;
  return {{"width", camera->width}, {"height", camera->height}, {"focal_length", rounded(camera->fx)}};
}

}  // namespace

Json reportObject(const CalibrationRun& run, const std::string& pictures) {
  const Calibration& calibration = run.calibration;
  Measurements measured = run.measurements;
  standInByRowOrder(measured.samples);
  const StageModels models = stageModels(calibration);
  std::vector<StageAt> at;
  for (const StageModel& stage : models.stages) at.emplace_back(stage, measured);
  ReportSource source{.calibration = calibration,
                      .identification = reportedIdentification(calibration),
                      .measurements = measured,
                      .models = models,
                      .at = at,
                      .before = {},
                      .after = {},
                      .before_size = {},
                      .after_size = {},
                      .shown = {},
                      .contexts = {}};
  addSizes(measured, at[models.before], source.before, source.before_size);
  addSizes(measured, at[models.after], source.after, source.after_size);
  source.shown = thinned(source.after_size, mostShown(measured));
  addContexts(source);
  const Verdict verdict = verdictOf(calibration);
  Json stages = Json::array();
  for (const StageModel& stage : models.stages) stages.push_back(stage.name);
  Json json{{"format", "poecal-report/1"},
            {"robot", source.identification.nominal.name},
            {"setup", setupName(measured.setup)},
            {"pixels", !measured.observations.front().pose},
            {"pictures", pictures},
            {"verdict", {{"headline", verdict.headline}, {"sentences", verdict.sentences}, {"actions", verdict.actions}}},
            {"warnings", calibration.warnings},
            {"counts", countsJson(source)},
            {"ladder", ladderJson(source)},
            {"models", stages},
            {"models_rms", modelsRmsJson(source)},
            {"model_before", models.before},
            {"model_after", models.after},
            {"camera", cameraJson(source)},
            {"curves", curvesJson(source)},
            {"parameters", parametersJson(source)},
            {"uncertainty", uncertaintyJson(source)},
            {"suspects", suspectsJson(source)},
            {"other_columns", measured.other_columns},
            {"arm", armJson(source)},
            {"samples", samplesJson(source)}};
  json["identification"] = identificationObject(*calibration.identification, measured.samples);
  const bool diagnosed = calibration.diagnosis || !calibration.no_diagnosis.empty();
  json["diagnosis"] = diagnosed ? diagnosisObject(calibration, measured) : Json(nullptr);
  return json;
}

std::string reportJson(const CalibrationRun& run, const std::string& pictures) { return reportText(reportObject(run, pictures)); }

std::string reportText(const Json& report) { return report.dump() + "\n"; }

}  // namespace poecal
