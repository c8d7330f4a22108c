#include "measuring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/registration/implausible.hpp"

namespace poecal::app {
namespace {

std::string registrationYaml(const CaptureInputs& inputs, const RegistrationResult& result) {
  const Registration& registration = result.cell.registration;
  Eigen::VectorXd deviation = result.adjustment.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (const int open : result.open) deviation(open) = std::numeric_limits<double>::infinity();
  const auto block = [&deviation](int begin) {
    return fmt::format("{{rotation: {}, translation: {}}}", yamlVector(deviation.segment<3>(begin)),
                       yamlVector(deviation.segment<3>(begin + 3)));
  };
  std::string text = "format: poecal-registration/1\n";
  text += fmt::format("setup: {}\n", setupName(registration.setup));
  text += fmt::format("T_camera_{}: {}\n", registration.nearFrame(), yamlPose(registration.T_camera_near));
  text += fmt::format("T_{}_target: {}\n", registration.farFrame(), yamlPose(registration.T_far_target));
  text += "standard_deviation:  # of left perturbations (rotation, translation) in the first-named frame, rad and m\n";
  text += fmt::format("  T_camera_{}: {}\n  T_{}_target: {}\n", registration.nearFrame(), block(0), registration.farFrame(), block(6));
  const auto left_out =
      std::count_if(result.samples.begin(), result.samples.end(), [](const RegisteredSample& sample) { return sample.left_out; });
  text += fmt::format("pictures: {}\npictures_with_corners: {}\npictures_left_out: {}\n", inputs.capture.table.samples.size(),
                      inputs.observations.size(), left_out);
  text += fmt::format("rms_px: {}\nrms_all_px: {}\nfree_rms_px: {}\ncorner_sigma_px: {}\n", formatNumber(result.rms_px),
                      formatNumber(result.rms_all_px), formatNumber(result.free_rms_px), formatNumber(result.corner_sigma_px));
  return text;
}

/// Three coordinates [m]; those that an open direction moves are marked.
std::string placeText(const Eigen::Vector3d& place, const std::optional<Eigen::Vector3d>& open_axis) {
  // A smaller component of the direction is that of noise in it.
  constexpr double kAlong = 0.02;
  std::string text;
  for (int k = 0; k < 3; ++k) {
    const bool open = open_axis && std::abs((*open_axis)(k)) > kAlong;
    text += fmt::format("{}{:.4f}{}", k == 0 ? "" : " ", place(k), open ? " (open)" : "");
  }
  return text;
}

/// Readable by `identify --poses` with --registered: the pose, its deviations, and behind them the whole covariance.
std::string flangePosesCsv(const CaptureInputs& inputs, const RegistrationResult& result) {
  std::vector<std::string> header{"image"};
  const int joints = inputs.cell.arm ? inputs.cell.arm->jointCount() : 0;
  for (int k = 1; k <= joints; ++k) header.push_back(fmt::format("q{}", k));
  for (const char* name :
       {"x", "y", "z", "qx", "qy", "qz", "qw", "sigma_position", "sigma_rotation", "rms_px", "free_rms_px", "left_out"}) {
    header.emplace_back(name);
  }
  for (int row = 1; row <= 6; ++row) {
    for (int column = row; column <= 6; ++column) header.push_back(fmt::format("cov{}{}", row, column));
  }
  CsvWriter csv(header);
  for (const RegisteredSample& sample : result.samples) {
    if (!sample.has_pose) continue;
    const Sample& row = inputs.capture.table.samples[sample.sample];
    csv.cell(row.image);
    for (int k = 0; k < joints; ++k) csv.cell(row.q(k));
    for (int k = 0; k < 3; ++k) csv.cell(sample.T_base_flange.translation()(k));
    const Eigen::Vector4d quaternion = quaternionXyzw(sample.T_base_flange);
    for (int k = 0; k < 4; ++k) csv.cell(quaternion(k));
    csv.cell(std::sqrt(sample.covariance.bottomRightCorner<3, 3>().trace() / 3.0));
    csv.cell(std::sqrt(sample.covariance.topLeftCorner<3, 3>().trace() / 3.0));
    csv.cell(sample.rms_px).cell(sample.free_rms_px).cell(static_cast<int>(sample.left_out));
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) csv.cell(sample.covariance(i, j));
    }
    csv.endRow();
  }
  return csv.str();
}

}  // namespace

Measuring measureCapture(const CaptureInputs& inputs, const std::filesystem::path& out) {
  Measuring measuring;
  RegistrationResult& result = measuring.registration;
  try {
    result = registerCell(inputs.cell, inputs.observations, {});
  } catch (const ImplausibleInput& suspicion) {
    throw fileErrorOf(suspicion, inputs.capture);
  }
  warnAll(result.warnings);
  writeTextFile(out / "registration.yaml", registrationYaml(inputs, result));
  writeTextFile(out / "flange_poses.csv", flangePosesCsv(inputs, result));

  const Registration& registration = result.cell.registration;
  const Eigen::Vector3d camera = registration.T_camera_near.inverse().translation();
  std::string left_out;
  nlohmann::json bad = nlohmann::json::array();
  for (const RegisteredSample& sample : result.samples) {
    if (!sample.left_out) continue;
    const Sample& row = inputs.capture.table.samples[sample.sample];
    left_out += fmt::format("  left out: {} (line {}), {:.2f} px\n", row.image, row.line, sample.rms_px);
    bad.push_back({{"image", row.image}, {"line", row.line}, {"rms_px", sample.rms_px}});
  }
  measuring.text =
      fmt::format("registered {} pictures: {:.3f} px rms ({:.3f} px with every picture, {:.3f} px with a free pose for each)\n",
                  result.samples.size(), result.rms_px, result.rms_all_px, result.free_rms_px);
  measuring.text += fmt::format("  camera in {}: {} m\n", registration.nearFrame(), placeText(camera, result.open_axis));
  if (result.open_axis) {
    const Eigen::Vector3d& axis = *result.open_axis;
    measuring.text +=
        fmt::format("  open: along ({:.3f} {:.3f} {:.3f}) of the {}, the one axis of all turns, nothing says where the camera is\n",
                    axis.x(), axis.y(), axis.z(), registration.nearFrame());
  }
  measuring.text += left_out;
  if (!inputs.cell.arm) measuring.text += "  no joint readings: only registration is possible, the arm cannot be identified\n";
  measuring.json = {{"pictures", result.samples.size()}, {"rms_px", result.rms_px}, {"rms_all_px", result.rms_all_px},
                    {"free_rms_px", result.free_rms_px}, {"left_out", bad},         {"joints", inputs.cell.arm.has_value()}};
  return measuring;
}

}  // namespace poecal::app
