// identification.json: what was found, how sure, and what the data could not see.
#include "identification/identification_json.hpp"

#include <cmath>

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Eigen::VectorXd& values) {
  Json list = Json::array();
  for (Eigen::Index k = 0; k < values.size(); ++k) list.push_back(values(k));
  return list;
}

Json lengths(const LengthSummary& summary, double factor) {
  return {{"mean", factor * summary.mean},
          {"median", factor * summary.median},
          {"rms", factor * summary.rms},
          {"p95", factor * summary.p95},
          {"max", factor * summary.max}};
}

Json errors(const ErrorSummary& summary) {
  Json json{{"poses", summary.poses}};
  if (summary.corners > 0) {
    json["corners"] = summary.corners;
    json["rms_px"] = summary.px.rms;
    json["px"] = lengths(summary.px, 1.0);
  }
  json["position_mm"] = lengths(summary.position, 1e3);
  json["rotation_mrad"] = lengths(summary.rotation, 1e3);
  json["rotation_deg"] = lengths(summary.rotation, 180.0 / M_PI);
  return json;
}

Json iterations(const Identification& identification) {
  Json list = Json::array();
  if (!identification.gao_residuals.empty()) {
    for (std::size_t k = 0; k < identification.gao_residuals.size(); ++k) {
      list.push_back({{"iteration", k}, {"rms_y", identification.gao_residuals[k]}});
    }
    return list;
  }
  for (std::size_t k = 0; k < identification.steps.size(); ++k) {
    const AdjustmentStep& step = identification.steps[k];
    list.push_back({{"iteration", k}, {"cost", step.cost}, {"rms", step.rms}, {"scale", step.scale}});
  }
  return list;
}

Json joints(const Identification& identification) {
  Json list = Json::array();
  const Arm& arm = *identification.model.cell.arm;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    Json joint{{"joint", k + 1},
               {"name", arm.joints[k].name},
               {"type", arm.joints[k].type == JointType::kRevolute ? "revolute" : "prismatic"},
               {"nominal", numbers(identification.nominal.joints[k].xi)},
               {"identified", numbers(arm.joints[k].xi)}};
    if (k < identification.model.deviation.twists.size()) joint["standard_deviation"] = numbers(identification.model.deviation.twists[k]);
    if (k < identification.joint_deviations.size()) {
      const JointDeviation& off = identification.joint_deviations[k];
      joint["from_nominal"] = {{"tilt", off.tilt}, {"shift", off.shift}, {"zero", off.zero}};
    }
    list.push_back(std::move(joint));
  }
  return list;
}

Json parameters(const Identification& identification) {
  Json list = Json::array();
  for (std::size_t k = 0; k < identification.parameter_names.size(); ++k) {
    Json parameter{{"name", identification.parameter_names[k]},
                   {"standard_deviation", identification.parameter_deviation(static_cast<Eigen::Index>(k))}};
    if (k < identification.prior_share.size()) parameter["variance_from_prior"] = identification.prior_share[k];
    list.push_back(std::move(parameter));
  }
  return list;
}

/// Where deviations were stated: how the residuals compare with them. Otherwise the deviations that the residuals show.
Json noise(const Identification& identification) {
  Json json{{"source", identification.sigmas_stated ? "stated, scaled by the residuals" : "estimated"}, {"scale", identification.scale}};
  if (identification.sigmas_stated) json["chi_square_per_degree_of_freedom"] = identification.reduced_chi_square;
  json["degrees_of_freedom"] = identification.degrees_of_freedom;
  if (!identification.sigmas_stated && identification.model.cell.camera && identification.method == Method::kBundle) {
    json["sigma_px"] = identification.scale;
  }
  if (!identification.model.cell.camera && !identification.sigmas_stated) {
    json["sigma_position_mm"] = 1e3 * identification.sigma_position;
    json["sigma_rotation_mrad"] = 1e3 * identification.sigma_rotation;
  }
  return json;
}

Json suspects(const Identification& identification, const std::vector<Sample>& samples) {
  Json list = Json::array();
  for (const SuspectRow& row : identification.suspects) {
    const Sample& sample = samples.at(row.sample);
    Json json{{"row", row.sample}, {"line", sample.line}};
    if (!sample.image.empty()) json["image"] = sample.image;
    const bool pixels = identification.model.cell.camera && identification.method == Method::kBundle;
    json[pixels ? "residual_px" : "residual_mm"] = pixels ? row.residual : 1e3 * row.residual;
    json["sigmas"] = row.sigmas;
    json["left_out"] = row.left_out;
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace

Json identificationObject(const Identification& identification, const std::vector<Sample>& samples) {
  Json json;
  json["format"] = "poecal-identification/1";
  json["method"] = methodName(identification.method);
  json["converged"] = identification.status == AdjustmentStatus::kConverged;
  json["poses"] = identification.poses;
  json["held_out"] = {{"poses", identification.held_out_poses}, {"scheme", identification.leave_one_out ? "leave one out" : "folds"}};
  json["iterations"] = iterations(identification);
  json["joints"] = joints(identification);
  const Arm& arm = *identification.model.cell.arm;
  json["gamma"] = {{"nominal", numbers(identification.nominal.gamma)}, {"identified", numbers(arm.gamma)}};
  if (identification.model.deviation.gamma) json["gamma"]["standard_deviation"] = numbers(*identification.model.deviation.gamma);
  json["observability"] = {{"parameters", identification.parameter_names.size()},
                           {"rank", identification.rank},
                           {"condition_number", identification.condition_number},
                           {"unseen", identification.unseen},
                           {"gauge", identification.gauge},
                           {"by_parameter", parameters(identification)}};
  json["noise"] = noise(identification);
  if (!identification.twist_prior.empty()) json["arm_beyond_tolerance"] = identification.arm_beyond_tolerance;
  if (identification.model.cell.camera) {
    json["camera_refitted"] = identification.camera_refitted;
  }
  json["stages"] = Json::array();
  for (const ModelStage& stage : identification.stages) {
    json["stages"].push_back({{"stage", stage.name},
                              {"calibration", errors(stage.calibration)},
                              {"held_out", errors(stage.held_out)},
                              {"held_out_kept", errors(stage.held_out_kept)}});
  }
  if (!identification.stages.empty()) {
    json["residuals"] = {{"calibration", errors(identification.stages.back().calibration)},
                         {"held_out", errors(identification.stages.back().held_out)}};
  }
  json["suspects"] = suspects(identification, samples);
  json["warnings"] = identification.warnings;
  return json;
}

std::string identificationJson(const Identification& identification, const std::vector<Sample>& samples) {
  return identificationObject(identification, samples).dump(2) + "\n";
}

}  // namespace poecal
