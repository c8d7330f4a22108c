#include "poecal/cell/measurements.hpp"

#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

// Where a table of poses states no deviations these are only where their estimation starts.
constexpr double kStartPosition = 1e-3, kStartRotation = 3e-3;

void addReference(const Capture& capture, const Detections& detections, std::vector<Observation>& observations) {
  std::map<std::size_t, std::vector<CornerMeasurement>> seen;
  for (Observation& observation : cornerObservations(capture.table, detections, *capture.reference)) {
    seen[observation.sample] = std::move(observation.corners);
  }
  for (Observation& observation : observations) {
    const auto found = seen.find(observation.sample);
    if (found != seen.end()) observation.reference = found->second;
  }
}

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

/// Takes up the further columns of a table that is about to be added.
void Measurements::beginRows(const SampleTable& table, const char* what, std::size_t count) {
  if (count != table.samples.size()) {
    throw InvalidArgument(fmt::format("{} {} for {} samples, expected one for each", count, what, table.samples.size()));
  }
  if (samples.empty()) other_columns = table.other_columns;
  if (table.other_columns == other_columns) return;
  throw InvalidArgument(fmt::format("the further columns are {}, expected {} as those before have", fmt::join(table.other_columns, ", "),
                                    fmt::join(other_columns, ", ")));
}

void Measurements::addPictures(const SampleTable& table, const std::vector<Eigen::MatrixX2d>& px, std::optional<double> sigma) {
  beginRows(table, "pictures", px.size());
  std::vector<std::vector<Corner>> corners(px.size());
  for (std::size_t k = 0; k < px.size(); ++k) {
    if (px[k].rows() != static_cast<Eigen::Index>(target.points.size())) {
      throw InvalidArgument(
          fmt::format("picture {}: {} corners, expected {} as the target has points", k, px[k].rows(), target.points.size()));
    }
    for (std::size_t j = 0; j < target.points.size(); ++j) {
      const Eigen::Vector2d at = px[k].row(static_cast<Eigen::Index>(j));
      if (at.array().isNaN().all()) continue;
      if (!at.allFinite()) throw InvalidArgument(fmt::format("picture {}: {} is half a number", k, nameOf(target.points[j].id)));
      corners[k].push_back({.id = target.points[j].id, .px = at, .sigma = sigma.value_or(std::numeric_limits<double>::quiet_NaN())});
    }
  }
  for (std::size_t k = 0; k < px.size(); ++k) addPicture(table.samples[k], corners[k]);
}

void Measurements::addPoses(const SampleTable& table, const std::vector<Eigen::Isometry3d>& T_instrument_tool,
                            std::optional<double> sigma_position, std::optional<double> sigma_rotation) {
  beginRows(table, "poses", T_instrument_tool.size());
  for (std::size_t k = 0; k < table.samples.size(); ++k) addPose(table.samples[k], T_instrument_tool[k], sigma_position, sigma_rotation);
}

void Measurements::addPositions(const SampleTable& table, const Eigen::MatrixX3d& p_instrument, std::optional<double> sigma_position) {
  beginRows(table, "positions", static_cast<std::size_t>(p_instrument.rows()));
  if (!p_instrument.allFinite()) throw InvalidArgument("a position is not finite, expected three numbers for each sample");
  for (std::size_t k = 0; k < table.samples.size(); ++k) {
    addPosition(table.samples[k], p_instrument.row(static_cast<Eigen::Index>(k)), sigma_position);
  }
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
  if (capture.reference) addReference(capture, detections, measurements.observations);
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
