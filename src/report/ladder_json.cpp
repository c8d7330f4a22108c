// The stages on held-out poses with their intervals.
#include <cmath>
#include <set>

#include "report/numbers.hpp"
#include "report/sections.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

Json scaledPair(const std::pair<double, double>& bounds, double unit) {
  return {rounded(unit * bounds.first), rounded(unit * bounds.second)};
}

Json stageJson(const std::string& name, double rms, const std::pair<double, double>& interval, double unit, const ErrorSummary& errors) {
  return {{"stage", name},
          {"rms", rounded(unit * rms)},
          {"rms_ci95", scaledPair(interval, unit)},
          {"position_mm", rounded(1e3 * errors.position.mean)},
          {"rotation_mrad", rounded(1e3 * errors.rotation.mean)}};
}

/// Of each pose, all its shots together, in the order of the groups.
std::vector<PoseSquares> poseSquares(const std::vector<RowErrors>& rows, const Measurements& measurements) {
  std::vector<std::size_t> group_of(measurements.observations.size());
  const std::vector<std::vector<std::size_t>> groups = measurements.poseGroups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const std::size_t k : groups[g]) group_of[k] = g;
  }
  std::vector<PoseSquares> poses(groups.size());
  for (const RowErrors& row : rows) {
    for (const double length : row.lengths) {
      poses[group_of[row.index]].squares += length * length;
      poses[group_of[row.index]].points += 1.0;
    }
  }
  return poses;
}

Json identifiedStages(const ReportSource& source, bool pixels) {
  Json stages = Json::array();
  for (const ModelStage& stage : source.identification.stages) {
    const bool held_out = stage.held_out.poses > 0;
    const ErrorSummary& errors = held_out ? stage.held_out : stage.calibration;
    const double rms = pixels ? errors.px.rms : errors.position.rms;
    const std::pair<double, double> interval =
        held_out ? rmsInterval(poseSquares(stage.held_out_rows, source.measurements)) : std::pair(rms, rms);
    stages.push_back(stageJson(stage.name, rms, interval, pixels ? 1.0 : 1e3, errors));
  }
  return stages;
}

}  // namespace

nlohmann::ordered_json ladderJson(const ReportSource& source) {
  const bool pixels = !source.measurements.observations.front().pose;
  const double unit = pixels ? 1.0 : 1e3;
  Json json{{"unit", pixels ? "px" : "mm"}};
  if (!source.calibration.diagnosis) {
    json["held_out"] = source.identification.held_out_poses > 0;
    json["stages"] = identifiedStages(source, pixels);
    json["noise"] = nullptr;
    if (source.calibration.registration && pixels) {
      const double free = source.calibration.registration->free_rms_px;
      json["free_pose"] = rounded(free);
    }
    return json;
  }
  const Diagnosis& diagnosis = *source.calibration.diagnosis;
  json["held_out"] = true;
  json["stages"] = Json::array();
  for (const GapStage& stage : diagnosis.stages) {
    Json each = stageJson(stage.stage, stage.rms, stage.rms_interval, unit, stage.errors);
    each["excess"] = rounded(unit * stage.excess);
    json["stages"].push_back(each);
  }
  json["noise"] = {{"known", diagnosis.noiseKnown()},
                   {"rms", rounded(unit * diagnosis.noise_rms)},
                   {"bounds", scaledPair(diagnosis.noise_bounds, unit)},
                   {"source", noiseSourceName(diagnosis.noise_source)}};
  return json;
}

}  // namespace poecal
