#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "capture/output_columns.hpp"
#include "cell/transform_names.hpp"
#include "core/yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/calibration/results.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

const RegistrationResult& registrationOf(const Calibration& calibration) {
  if (!calibration.registration) throw InvalidArgument("nothing was registered from pictures: there is no registration to write");
  return *calibration.registration;
}

}  // namespace

std::string registrationYaml(const Calibration& calibration, const Measurements& measurements) {
  const RegistrationResult& result = registrationOf(calibration);
  const Registration& registration = result.cell.registration;
  Eigen::VectorXd deviation = result.adjustment.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (const int open : result.open) deviation(open) = std::numeric_limits<double>::infinity();
  const auto block = [&deviation](int begin) {
    return fmt::format("{{rotation: {}, translation: {}}}", yamlVector(deviation.segment<3>(begin)),
                       yamlVector(deviation.segment<3>(begin + 3)));
  };
  std::string text = "format: poecal-registration/1\n";
  text += fmt::format("setup: {}\n", setupName(registration.setup));
  const std::string near = nearName(registration), far = farName(registration);
  text += fmt::format("{}: {}\n{}: {}\n", near, yamlPose(registration.T_camera_near), far, yamlPose(registration.T_far_target));
  text += "standard_deviation:  # of left perturbations (rotation, translation) in the first-named frame, rad and m\n";
  text += fmt::format("  {}: {}\n  {}: {}\n", near, block(0), far, block(6));
  const auto left_out = std::count_if(result.samples.begin(), result.samples.end(), [](const RegisteredSample& s) { return s.left_out; });
  text += fmt::format("pictures: {}\npictures_with_corners: {}\npictures_left_out: {}\n", measurements.samples.size(),
                      measurements.observations.size(), left_out);
  text += fmt::format("rms_px: {}\nrms_all_px: {}\nfree_rms_px: {}\ncorner_sigma_px: {}\n", formatNumber(result.rms_px),
                      formatNumber(result.rms_all_px), formatNumber(result.free_rms_px), formatNumber(result.corner_sigma_px));
  return text;
}

std::string flangePosesCsv(const Calibration& calibration, const Measurements& measurements) {
  const RegistrationResult& result = registrationOf(calibration);
  const std::vector<OutputColumn> readings = readingColumns(measurements.samples);
  const std::vector<OutputColumn> others = otherColumns(measurements.samples, measurements.other_columns);
  std::vector<std::string> header{"image"};
  for (const OutputColumn& column : readings) header.push_back(column.name);
  for (const char* name :
       {"x", "y", "z", "qx", "qy", "qz", "qw", "sigma_position", "sigma_rotation", "rms_px", "free_rms_px", "left_out"}) {
    header.emplace_back(name);
  }
  for (int row = 1; row <= 6; ++row) {
    for (int column = row; column <= 6; ++column) header.push_back(fmt::format("cov{}{}", row, column));
  }
  for (const OutputColumn& column : others) header.push_back(column.name);
  CsvWriter csv(header);
  for (const RegisteredSample& sample : result.samples) {
    if (!sample.has_pose) continue;
    const Sample& row = measurements.samples[sample.sample];
    csv.cell(row.image);
    for (const OutputColumn& column : readings) column.write(row, csv);
    for (const double t : sample.T_base_flange.translation()) csv.cell(t);
    const Eigen::Vector4d quaternion = quaternionXyzw(sample.T_base_flange);
    for (const double c : quaternion) csv.cell(c);
    csv.cell(std::sqrt(sample.covariance.bottomRightCorner<3, 3>().trace() / 3.0));
    csv.cell(std::sqrt(sample.covariance.topLeftCorner<3, 3>().trace() / 3.0));
    csv.cell(sample.rms_px).cell(sample.free_rms_px).cell(static_cast<int>(sample.left_out));
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) csv.cell(sample.covariance(i, j));
    }
    for (const OutputColumn& column : others) column.write(row, csv);
    csv.endRow();
  }
  return csv.str();
}

}  // namespace poecal
