// How well the tool's place is known over the workspace, and how far each axis was moved.
#include <algorithm>
#include <cmath>

#include "report/numbers.hpp"
#include "report/sections.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

/// Van der Corput's sequence, of which Halton's takes one base for each dimension.
double radicalInverse(std::size_t index, std::size_t base) {
  double value = 0.0, digit = 1.0 / static_cast<double>(base);
  for (; index > 0; index /= base, digit /= static_cast<double>(base)) value += digit * static_cast<double>(index % base);
  return value;
}

/// Where the joints may be: their limits; a turning joint without any, one turn; a sliding one, where it was.
std::vector<JointLimits> ranges(const Arm& arm, const std::vector<Sample>& samples) {
  std::vector<JointLimits> all;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    JointLimits range{-M_PI, M_PI};
    if (arm.joints[k].type == JointType::kPrismatic) {
      const auto j = static_cast<Eigen::Index>(k);
      range = {samples.front().q(j), samples.front().q(j)};
      for (const Sample& sample : samples) range = {std::min(range.lower, sample.q(j)), std::max(range.upper, sample.q(j))};
    }
    if (arm.joints[k].limits) {
      range = {std::max(arm.joints[k].limits->lower, arm.joints[k].type == JointType::kRevolute ? -M_PI : arm.joints[k].limits->lower),
               std::min(arm.joints[k].limits->upper, arm.joints[k].type == JointType::kRevolute ? M_PI : arm.joints[k].limits->upper)};
    }
    all.push_back(range);
  }
  return all;
}

/// sqrt(trace) of the covariance of the place of the target before the camera [mm].
double toolDeviation(const Identification& identification, const Observation& at, const Eigen::Isometry3d& T_camera_target) {
  const Matrix6d covariance = targetPoseCovariance(identification.adjustment, identification.start, identification.free, at);
  Eigen::Matrix<double, 3, 6> J;
  J << -hat(T_camera_target.translation()), Eigen::Matrix3d::Identity();
  return 1e3 * std::sqrt(std::max(0.0, (J * covariance * J.transpose()).trace()));
}

}  // namespace

nlohmann::ordered_json uncertaintyJson(const ReportSource& source) {
  constexpr std::size_t kPostures = 600;
  constexpr std::size_t kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  const Identification& identification = source.identification;
  const Arm& arm = *identification.model.cell.arm;
  if (identification.method != Method::kBundle || arm.joints.size() > std::size(kPrimes)) return nullptr;
  const std::vector<JointLimits> range = ranges(arm, source.measurements.samples);
  Json places = Json::array(), deviations = Json::array();
  for (std::size_t number = 1; number <= kPostures; ++number) {
    Observation at;
    at.q.resize(arm.jointCount());
    for (std::size_t k = 0; k < arm.joints.size(); ++k) {
      at.q(static_cast<Eigen::Index>(k)) = range[k].lower + (range[k].upper - range[k].lower) * radicalInverse(number, kPrimes[k]);
    }
    const Eigen::Isometry3d T_base_flange = forwardKinematics(arm, at.q);
    const Eigen::Isometry3d T_camera_target = identification.model.cell.registration.cameraTarget(T_base_flange);
    places.push_back(roundedList(T_base_flange.translation(), 4));
    deviations.push_back(rounded(toolDeviation(identification, at, T_camera_target), 4));
  }
  return {{"flange", places}, {"deviation_mm", deviations}};
}

nlohmann::ordered_json parametersJson(const ReportSource& source) {
  const Identification& identification = source.identification;
  const Eigen::VectorXd& beta = identification.adjustment.beta;
  Json list = Json::array();
  for (std::size_t k = 0; k < identification.parameter_names.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    Json json{{"name", identification.parameter_names[k]},
              {"value", row < beta.size() ? rounded(beta(row)) : Json(nullptr)},
              {"standard_deviation", rounded(identification.parameter_deviation(row))}};
    if (k < identification.prior_share.size()) json["variance_from_prior"] = rounded(identification.prior_share[k], 3);
    list.push_back(json);
  }
  return list;
}

}  // namespace poecal
