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
  const bool stated = sigma_position && sigma_rotation;
  sigmas_stated = stated && (sigmas_stated || observations.empty());
  samples.push_back(sample);
  Observation observation = poseObservation(
      {.sample = sample, .T_instrument_tool = T_instrument_tool, .sigma_position = sigma_position, .sigma_rotation = sigma_rotation},
      kStartPosition, kStartRotation);
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
  measurements.observations = poseObservations(table, kStartPosition, kStartRotation);
  measurements.sigmas_stated = !table.poses.empty();
  for (const MeasuredPose& pose : table.poses) {
    measurements.samples.push_back(pose.sample);
    const bool stated = pose.sigma_position && (pose.sigma_rotation || pose.position_only);
    measurements.sigmas_stated = measurements.sigmas_stated && stated;
  }
  return measurements;
}

}  // namespace poecal
