#include "poecal/cell/measurements.hpp"

#include <cmath>

#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

// Where a table of poses states no deviations these are only where their estimation starts.
constexpr double kStartPosition = 1e-3, kStartRotation = 3e-3;

std::string nameOf(const PointId& id) { return fmt::format("tag {}, corner {}", id.tag, id.corner); }

}  // namespace

void Measurements::addPicture(const Sample& sample, const std::vector<Corner>& corners) {
  for (const Corner& corner : corners) {
    if (target.find(corner.id) == nullptr) {
      throw InvalidArgument(fmt::format("{} is not on the target, expected one of its points", nameOf(corner.id)));
    }
    sigmas_stated = sigmas_stated || std::isfinite(corner.sigma);
  }
  samples.push_back(sample);
  Observation observation = cornerObservation(sample, corners, target);
  if (observation.corners.empty()) return;
  observation.sample = samples.size() - 1;
  observations.push_back(std::move(observation));
}

void Measurements::addPose(const Sample& sample, const Eigen::Isometry3d& T_instrument_tool, std::optional<double> sigma_position,
                           std::optional<double> sigma_rotation) {
  addMeasured(
      {.sample = sample, .T_instrument_tool = T_instrument_tool, .sigma_position = sigma_position, .sigma_rotation = sigma_rotation});
}

void Measurements::addPosition(const Sample& sample, const Eigen::Vector3d& p_instrument, std::optional<double> sigma_position) {
  Eigen::Isometry3d T_instrument_tool = Eigen::Isometry3d::Identity();
  T_instrument_tool.translation() = p_instrument;
  addMeasured({.sample = sample,
               .T_instrument_tool = T_instrument_tool,
               .position_only = true,
               .sigma_position = sigma_position,
               .sigma_rotation = std::nullopt});
}

void Measurements::addMeasured(const MeasuredPose& measured) {
  const bool stated = measured.sigma_position && (measured.sigma_rotation || measured.position_only);
  sigmas_stated = stated && (sigmas_stated || observations.empty());
  samples.push_back(measured.sample);
  Observation observation = poseObservation(measured, kStartPosition, kStartRotation);
  observation.sample = samples.size() - 1;
  observations.push_back(std::move(observation));
}

std::vector<std::vector<std::size_t>> Measurements::poseGroups() const {
  if (!groups.empty()) return groups;
  std::vector<Sample> rows;
  for (const Observation& observation : observations) rows.push_back(samples.at(observation.sample));
  return poecal::poseGroups(rows);
}

Measurements measurementsOf(const Capture& capture, const Detections& detections) {
  Measurements measurements;
  measurements.setup = capture.setup;
  measurements.target = capture.target;
  measurements.gravity = capture.gravity;
  measurements.samples = capture.table.samples;
  measurements.other_columns = capture.table.other_columns;
  measurements.observations = cornerObservations(capture.table, detections, capture.target);
  for (const ImageCorners& image : detections.images) {
    for (const Corner& corner : image.corners) measurements.sigmas_stated = measurements.sigmas_stated || std::isfinite(corner.sigma);
  }
  return measurements;
}

Measurements measurementsOf(const PoseTable& table) {
  Measurements measurements;
  measurements.other_columns = table.other_columns;
  for (const MeasuredPose& pose : table.poses) measurements.addMeasured(pose);
  return measurements;
}

}  // namespace poecal
