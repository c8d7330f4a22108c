// Samples of the report: readings, drivers, corners and residuals.
#include <cmath>

#include "report/numbers.hpp"
#include "report/sections.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPixelDigits = 6;
constexpr int kResidualDigits = 4;
constexpr int kStampDigits = 13;    // of seconds since 1970 a millisecond
constexpr double kJointUnit = 1e3;  // mrad of an angle, mm of a shift

Json readings(const ReportSource& source, std::size_t number, const Sample& sample) {
  Json json{{"q", roundedList(sample.q)}};
  const SampleContext& context = source.contexts[number];
  if (context.torque.size() > 0 && context.torque.allFinite()) json["torque"] = roundedList(context.torque);
  if (sample.dir.size() > 0) json["dir"] = roundedList(sample.dir);
  if (sample.stamp) json["stamp"] = rounded(*sample.stamp, kStampDigits);
  if (sample.temperature) json["temperature"] = rounded(*sample.temperature);
  if (!sample.other.empty())
    json["other"] = roundedList(Eigen::Map<const Eigen::VectorXd>(sample.other.data(), static_cast<Eigen::Index>(sample.other.size())));
  return json;
}

/// Of poses (mrad; mm), of positions mm, of corners px.
Eigen::VectorXd shownUnits(const Observation& observation, const Eigen::VectorXd& r) {
  return observation.pose ? Eigen::VectorXd(1e3 * r) : r;
}

Json sampleJson(const ReportSource& source, std::size_t number) {
  const std::size_t k = source.shown[number];
  const Observation& observation = source.measurements.observations[k];
  const Sample& sample = source.measurements.samples[observation.sample];
  Json json{{"sample", observation.sample}, {"image", sample.image}, {"line", sample.line}};
  json.update(readings(source, number, sample));
  if (!observation.pose) {
    Eigen::VectorXd px(2 * static_cast<Eigen::Index>(observation.corners.size()));
    for (std::size_t j = 0; j < observation.corners.size(); ++j)
      px.segment<2>(2 * static_cast<Eigen::Index>(j)) = observation.corners[j].px;
    json["corners"] = roundedList(px, kPixelDigits);
  }
  Json residuals = Json::array(), sizes = Json::array();
  const double unit = observation.pose ? 1e3 : 1.0;
  for (const StageAt& stage : source.at) {
    const Eigen::VectorXd r = stage.residual(observation);
    residuals.push_back(roundedList(shownUnits(observation, r), kResidualDigits));
    sizes.push_back(rounded(unit * residualSize(observation, r)));
  }
  json["residuals"] = residuals;
  json["sizes"] = sizes;
  const StageModel& model = source.models.stages[source.models.after];
  const MeasuredMotion motion(model.cell, sample, observation, source.measurements.target);
  json["joint_errors"] = {{"before", roundedList(kJointUnit * motion.jointErrors(source.before[k]), kResidualDigits)},
                          {"after", roundedList(kJointUnit * motion.jointErrors(source.after[k]), kResidualDigits)}};
  return json;
}

}  // namespace

double residualSize(const Observation& observation, const Eigen::VectorXd& r) {
  if (observation.pose) return r.tail<3>().norm();
  double squares = 0.0;
  int corners = 0;
  for (Eigen::Index j = 0; j + 1 < r.size(); j += 2) {
    if (!r.segment<2>(j).allFinite()) continue;
    squares += r.segment<2>(j).squaredNorm();
    ++corners;
  }
  return corners > 0 ? std::sqrt(squares / corners) : 0.0;
}

nlohmann::ordered_json samplesJson(const ReportSource& source) {
  Json list = Json::array();
  for (std::size_t number = 0; number < source.shown.size(); ++number) list.push_back(sampleJson(source, number));
  return list;
}

}  // namespace poecal
