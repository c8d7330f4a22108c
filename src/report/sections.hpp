// The parts of report.json.
#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/stage_models.hpp"

namespace poecal {

/// What all parts are made from.
struct ReportSource {
  const Calibration& calibration;
  const Identification& identification;  ///< that the diagnosis started from
  const Measurements& measurements;      ///< samples with what the order of the rows stands in for
  const StageModels& models;
  const std::vector<StageAt>& at;               ///< of each stage
  std::vector<Eigen::VectorXd> before, after;   ///< residuals of every observation
  std::vector<double> before_size, after_size;  ///< root mean square length of its corners [px], or distance [m]
  std::vector<std::size_t> shown;               ///< observations that the page shows, ascending
  std::vector<SampleContext> contexts;          ///< of those shown
};

/// Root mean square length of corners [px]; of a pose the distance [m].
double residualSize(const Observation& observation, const Eigen::VectorXd& r);

/// The ladder: rms of every stage on held-out poses with its interval, and the noise.
nlohmann::ordered_json ladderJson(const ReportSource& source);
/// Samples with what every stage leaves of them.
nlohmann::ordered_json samplesJson(const ReportSource& source);
/// What drives each finding at each sample, what the model without and with it leaves, and its curve.
nlohmann::ordered_json curvesJson(const ReportSource& source);
/// The arm in space: nominal and identified axes, camera and target at some of the samples.
nlohmann::ordered_json armJson(const ReportSource& source);
/// Standard deviation of the tool's place over the workspace [mm].
nlohmann::ordered_json uncertaintyJson(const ReportSource& source);
/// How each axis was moved, with its deviation.
nlohmann::ordered_json parametersJson(const ReportSource& source);

}  // namespace poecal
