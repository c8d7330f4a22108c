// diagnosis.json, as the contract words it.
#include "diagnosis/diagnosis_json.hpp"

#include <cmath>

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

Json interval(const std::pair<double, double>& bounds) { return {bounds.first, bounds.second}; }

Json scaled(const std::pair<double, double>& bounds, double unit) { return {unit * bounds.first, unit * bounds.second}; }

Json gapJson(const Diagnosis& diagnosis) {
  // Poses of an instrument have no pixels: their errors are lengths.
  const double unit = diagnosis.pixels ? 1.0 : 1e3;
  const std::string suffix = diagnosis.pixels ? "_px" : "_mm";
  Json stages = Json::array();
  for (const GapStage& stage : diagnosis.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"rms" + suffix, diagnosis.pixels ? stage.errors.px.rms : 1e3 * stage.errors.position.rms},
                      {"rms_kept" + suffix, unit * stage.rms},
                      {"excess" + suffix, unit * stage.excess},
                      {"position_mm", 1e3 * stage.errors.position.mean},
                      {"position_mm_p95", 1e3 * stage.errors.position.p95},
                      {"position_mm_max", 1e3 * stage.errors.position.max},
                      {"rotation_mrad", 1e3 * stage.errors.rotation.mean},
                      {"rotation_mrad_p95", 1e3 * stage.errors.rotation.p95},
                      {"rotation_mrad_max", 1e3 * stage.errors.rotation.max}});
  }
  return {{"stages", stages},
          {"before_excess" + suffix, unit * diagnosis.before_excess},
          {"after_excess" + suffix, unit * diagnosis.after_excess},
          {"after_excess_ci95" + suffix, scaled(diagnosis.after_interval, unit)},
          {"noise_rms" + suffix, diagnosis.noiseKnown() ? Json(unit * diagnosis.noise_rms) : Json(nullptr)},
          {"noise_rms_bounds" + suffix, scaled(diagnosis.noise_bounds, unit)},
          {"shrinkage", diagnosis.shrinkage.value},
          {"shrinkage_ci95", interval(diagnosis.shrinkage.interval)},
          {"shrinkage_claimed", diagnosis.shrinkage.claimed()}};
}

Json noiseJson(const Diagnosis& diagnosis) {
  Json json;
  if (diagnosis.pixels) {
    json = {{"pixel_sigma", diagnosis.noise_sigma},
            {"source", noiseSourceName(diagnosis.noise_source)},
            {"tag_sigma_px", diagnosis.tag_sigma},
            {"joint_repeatability", diagnosis.repeatability}};
  } else {
    json = {{"position_sigma", diagnosis.noise_sigma},
            {"rotation_sigma", diagnosis.rotation_sigma},
            {"source", noiseSourceName(diagnosis.noise_source)}};
  }
  json["arm_beyond_tolerance"] = diagnosis.arm_beyond_tolerance;
  return json;
}

Json findingJson(const Finding& finding) {
  Json alternatives = Json::array();
  for (const AlternativeCause& other : finding.alternatives) {
    alternatives.push_back(
        {{"effect", other.effect}, {"location", other.location}, {"driver", other.driver}, {"probability", other.probability}});
  }
  Json json{{"effect", finding.effect},
            {"location", finding.location},
            {"driver", finding.driver},
            {"parameters", finding.parameters},
            {"standard_deviation", finding.standard_deviation},
            {"units", finding.units},
            {"probability", finding.probability},
            {"p_value", finding.p_value},
            {"log_evidence", finding.log_evidence},
            {"shrinkage", finding.shrinkage.value},
            {"shrinkage_ci95", interval(finding.shrinkage.interval)},
            {"shrinkage_claimed", finding.shrinkage.claimed()},
            {"alternatives", alternatives},
            {"separate_with", finding.separate_with},
            {"remedy", finding.remedy}};
  if (finding.largest_deflection) json["largest_deflection_mrad"] = 1e3 * *finding.largest_deflection;
  if (finding.largest_deflection_deviation) json["largest_deflection_deviation_mrad"] = 1e3 * *finding.largest_deflection_deviation;
  if (!finding.reference.empty()) json["reference"] = finding.reference;
  if (!finding.images.empty()) json["samples"] = finding.images;
  return json;
}

Json orNull(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

}  // namespace

Json diagnosisObject(const Diagnosis& diagnosis, const std::vector<Sample>& samples) {
  Json findings = Json::array(), where = Json::array(), detectable = Json::array(), not_testable = Json::array(), bad = Json::array(),
       moves = Json::array(), possibilities = Json::array();
  for (const Finding& finding : diagnosis.findings) findings.push_back(findingJson(finding));
  for (const Finding& finding : diagnosis.possibilities) possibilities.push_back(findingJson(finding));
  for (const GapPlace& place : diagnosis.where) {
    where.push_back({{"location", place.location}, {"driver", place.driver}, {"share", place.share}, {"p_value", place.p_value}});
  }
  for (const Detectable& each : diagnosis.detectable) {
    detectable.push_back({{"effect", each.effect}, {"location", each.location}, {"smallest", each.smallest}, {"unit", each.unit}});
  }
  for (const NotTestable& each : diagnosis.not_testable) {
    not_testable.push_back({{"effect", each.effect}, {"location", each.location}, {"why", each.why}});
  }
  for (const BadSample& row : diagnosis.bad_samples) {
    bad.push_back({{"image", samples[row.sample].image},
                   {"line", samples[row.sample].line},
                   {diagnosis.pixels ? "rms_px" : "distance", row.residual}});
  }
  for (const AxisMove& move : diagnosis.axis_moves) {
    moves.push_back({{"joint", move.joint}, {"tilt_mrad", 1e3 * move.tilt}, {"shift_mm", 1e3 * move.shift}});
  }
  return {{"format", "poecal-diagnosis/1"},
          {"verdict", diagnosis.findings.empty() ? "none" : "effects"},
          {"search", {{"explanations", diagnosis.answers}, {"log_odds_against_none", diagnosis.log_odds}}},
          {"noise", noiseJson(diagnosis)},
          {"gap", gapJson(diagnosis)},
          {"findings", findings},
          {"possibilities", possibilities},
          {"row_order", {{"stands_in_for_stamp", diagnosis.row_order.stamp}, {"dir_guessed", diagnosis.row_order.dir}}},
          {"where", where},
          {"remaining",
           {{"excess" + std::string(diagnosis.pixels ? "_px" : "_mm"), (diagnosis.pixels ? 1.0 : 1e3) * diagnosis.after_excess},
            {"gap_remains", diagnosis.gap_remains},
            {"significant", diagnosis.remaining_significant},
            {"p_value", diagnosis.remaining_p_value},
            {"location", orNull(diagnosis.remaining_location)},
            {"driver", orNull(diagnosis.remaining_driver)}}},
          {"bad_samples", bad},
          {"axis_moves", moves},
          {"detectable", detectable},
          {"not_testable", not_testable}};
}

std::string diagnosisJson(const Diagnosis& diagnosis, const std::vector<Sample>& samples) {
  return diagnosisObject(diagnosis, samples).dump(2) + "\n";
}

}  // namespace poecal
