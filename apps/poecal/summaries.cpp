#include "summaries.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "poecal/core/printable.hpp"

namespace poecal::app {
namespace {

// All steps together are to fit one screen.
constexpr std::size_t kShownRows = 6;

std::string errorText(const ErrorSummary& errors) {
  if (errors.poses == 0) return "-";
  std::string text;
  if (errors.corners > 0) text = fmt::format("{:9.3f} px   ", errors.px.rms);
  text += fmt::format("{:8.3f} mm", 1e3 * errors.position.mean);
  const bool positions_alone = errors.corners == 0 && errors.rotation.max == 0.0;
  return positions_alone ? text : text + fmt::format(" {:8.3f} mrad", 1e3 * errors.rotation.mean);
}

/// nominal -> registered -> identified, on calibration and on held-out poses.
std::string stagesText(const Identification& identification) {
  const bool pixels = identification.stages.front().calibration.corners > 0;
  const char* const held_out = identification.leave_one_out ? "one pose held out at a time" : "held-out poses";
  std::string text = fmt::format("  {:<12}{:<42}{}\n", "", "calibration", held_out);
  text += fmt::format("  {:<12}{}\n", "", pixels ? "px rms, mean mm and mrad of the flange" : "mean mm and mrad");
  for (const ModelStage& stage : identification.stages) {
    text += fmt::format("  {:<12}{:<42}{}\n", stage.name, errorText(stage.calibration), errorText(stage.held_out));
  }
  const ModelStage& last = identification.stages.back();
  const int set_aside = last.held_out.poses - last.held_out_kept.poses;
  if (set_aside > 0) {
    text += fmt::format("  {:<54}{}\n", fmt::format("identified, without the {} {} set aside", set_aside, set_aside == 1 ? "row" : "rows"),
                        errorText(last.held_out_kept));
  }
  return text;
}

std::string suspectText(const Identification& identification, const std::vector<Sample>& samples) {
  std::string text;
  for (std::size_t k = 0; k < identification.suspects.size() && k < kShownRows; ++k) {
    const SuspectRow& row = identification.suspects[k];
    const Sample& sample = samples[row.sample];
    text += fmt::format("  {}: line {}{}, {:.1f} sigma\n", row.left_out ? "left out" : "outlier", sample.line,
                        sample.image.empty() ? "" : " (" + sample.image + ")", row.sigmas);
  }
  if (identification.suspects.size() > kShownRows) {
    text += fmt::format("  and {} more, see identification.json\n", identification.suspects.size() - kShownRows);
  }
  return text;
}

/// Three coordinates [m]; those that an open direction moves are marked.
std::string placeText(const Eigen::Vector3d& place, const std::array<bool, 3>& open) {
  std::string text;
  for (int k = 0; k < 3; ++k) {
    text += fmt::format("{}{:.4f}{}", k == 0 ? "" : " ", place(k), open[static_cast<std::size_t>(k)] ? " (open)" : "");
  }
  return text;
}

}  // namespace

std::string registrationText(const CalibrationRun& run) {
  const RegistrationResult& result = *run.calibration.registration;
  const Registration& registration = result.cell.registration;
  const Eigen::Vector3d camera = registration.T_camera_near.inverse().translation();
  std::string text =
      fmt::format("registered {} pictures: {:.3f} px rms ({:.3f} px with every picture, {:.3f} px with a free pose for each)\n",
                  result.samples.size(), result.rms_px, result.rms_all_px, result.free_rms_px);
  text += fmt::format("  camera in {}: {} m\n", registration.nearFrame(), placeText(camera, result.open_near));
  if (result.open_axis) {
    const Eigen::Vector3d& axis = *result.open_axis;
    text += fmt::format("  open: along ({:.3f} {:.3f} {:.3f}) of the {}, the one axis of all turns, nothing says where the camera is\n",
                        axis.x(), axis.y(), axis.z(), registration.nearFrame());
  }
  std::size_t left_out = 0;
  for (const RegisteredSample& sample : result.samples) {
    if (!sample.left_out || ++left_out > kShownRows) continue;
    const Sample& row = run.measurements.samples[sample.sample];
    text += fmt::format("  left out: {} (line {}), {:.2f} px\n", row.image, row.line, sample.rms_px);
  }
  if (left_out > kShownRows) text += fmt::format("  and {} more left out, see flange_poses.csv\n", left_out - kShownRows);
  if (!result.cell.arm) text += "  no joint readings: only registration is possible, the arm cannot be identified\n";
  return text;
}

std::string registrationSummaryJson(const CalibrationRun& run) {
  const RegistrationResult& result = *run.calibration.registration;
  nlohmann::ordered_json left_out = nlohmann::json::array();
  for (const RegisteredSample& sample : result.samples) {
    const Sample& row = run.measurements.samples[sample.sample];
    if (sample.left_out) left_out.push_back({{"image", row.image}, {"line", row.line}, {"rms_px", sample.rms_px}});
  }
  const nlohmann::ordered_json json{
      {"pictures", result.samples.size()}, {"rms_px", result.rms_px}, {"rms_all_px", result.rms_all_px},
      {"free_rms_px", result.free_rms_px}, {"left_out", left_out},    {"joints", result.cell.arm.has_value()}};
  return json.dump(2) + "\n";
}

std::string identificationText(const CalibrationRun& run) {
  const Identification& identification = *run.calibration.identification;
  std::string text = fmt::format("identified {} by {} from {} poses\n", printableLine(identification.model.cell.arm->name),
                                 methodName(identification.method), identification.poses);
  if (!identification.stages.empty()) text += stagesText(identification);
  if (identification.model.cell.camera && identification.method == Method::kBundle) {
    text += identification.sigmas_stated
                ? fmt::format("  noise {:.3f} of what the corners state, chi-square per degree of freedom {:.3f}\n", identification.scale,
                              identification.reduced_chi_square)
                : fmt::format("  noise {:.3f} px per axis\n", identification.scale);
  }
  constexpr double kWorthSaying = 2.0;
  if (identification.arm_beyond_tolerance > kWorthSaying) {
    text += fmt::format("  the arm is {:.1f} times farther from its robot file than the tolerances say; the fit allowed for that\n",
                        identification.arm_beyond_tolerance);
  }
  // Six motions of the base frame are always among them; what the transforms have to do with is the measurements' lack.
  for (const std::string& direction : identification.unseen) {
    if (direction.find("T_") != std::string::npos) text += fmt::format("  not determined by these poses: {}\n", direction);
  }
  return text + suspectText(identification, run.measurements.samples);
}

std::string diagnosisSummary(const CalibrationRun& run, TextLength length) {
  const Calibration& calibration = run.calibration;
  if (!calibration.diagnosis) return fmt::format("no diagnosis: {}\n", calibration.no_diagnosis);
  std::string text = diagnosisText(*calibration.diagnosis, run.measurements.samples, length);
  if (calibration.model_source == ModelSource::kIdentified && !calibration.diagnosis->findings.empty()) {
    text += fmt::format("  model.yaml is the identified one, without effects: {}\n", calibration.model_reason);
  }
  return text;
}

}  // namespace poecal::app
