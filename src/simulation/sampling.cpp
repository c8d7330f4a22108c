// Joint readings of a scene, and the exact corners that belong to them.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "cell/sight.hpp"
#include "cell/visible_poses.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/random.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/simulation/simulate.hpp"
#include "simulation/streams.hpp"
#include "simulation/true_cell.hpp"

namespace poecal {
namespace {

constexpr int kDrawsOfPose = 1000;
constexpr double kSecondsBetweenRows = 10.0;
constexpr double kFastest = 0.1;      ///< joint speeds of captures in motion [rad/s] or [m/s]
constexpr double kColdStart = 20.0;   ///< [degrees Celsius]
constexpr double kWarmUp = 15.0;      ///< [K], nearly all of it within the capture
constexpr double kWarmUpTimes = 3.0;  ///< time constants in a capture

Eigen::VectorXd drawPose(const Scene& scene, const std::vector<JointLimits>& ranges, Rng& rng, int pose) {
  for (int draw = 0; draw < kDrawsOfPose; ++draw) {
    const Eigen::VectorXd q = drawReading(ranges, rng);
    if (wellInView(scene.camera, scene.target, scene.registration.cameraTarget(forwardKinematics(scene.actual, q)))) return q;
  }
  throw InsufficientData(
      fmt::format("pose {} of {}: the target is not well in view in any of {} random joint positions; expected a registration, "
                  "a lens or joint limits that bring it before the camera more often",
                  pose + 1, scene.count, kDrawsOfPose));
}

/// Columns that some effect is driven by and that a capture without it does not have.
void addDrivers(const Scene& scene, SampleTable& table) {
  bool moves = false, warms = false;
  for (const AppliedEffect& applied : scene.effects) {
    moves = moves || applied.effect.driver().kind() == DriverKind::kVelocity;
    warms = warms || applied.effect.driver().kind() == DriverKind::kTemperature;
  }
  Rng rng(scene.seed, streamOf(Purpose::kDrivers));
  const auto rows = static_cast<double>(table.samples.size());
  for (std::size_t row = 0; row < table.samples.size(); ++row) {
    Sample& sample = table.samples[row];
    if (moves) {
      sample.dq.resize(sample.q.size());
      for (double& speed : sample.dq) speed = rng.uniform(-kFastest, kFastest);
    }
    if (warms) sample.temperature = kColdStart + kWarmUp * (1.0 - std::exp(-kWarmUpTimes * static_cast<double>(row) / rows));
  }
}

/// +1 or -1 per joint; 0 where it did not move.
Eigen::VectorXd directions(const Eigen::VectorXd& from, const Eigen::VectorXd& to) { return (to - from).cwiseSign(); }

}  // namespace

SampleTable drawSamples(const Scene& scene, const SimulateOptions& options) {
  if (!scene.samples_file.empty()) return readSamples(scene.samples_file, scene.nominal.jointCount(), &scene.nominal);
  const std::vector<JointLimits> ranges = readingRanges(scene.nominal, scene.robot_file);
  Rng rng(scene.seed, streamOf(Purpose::kSamples));
  SampleTable table;
  table.has_joints = true;
  Eigen::VectorXd previous;
  Progress told(options.progress, "drawing poses", static_cast<std::size_t>(scene.count));
  for (int pose = 0; pose < scene.count; ++pose) {
    const Eigen::VectorXd q = drawPose(scene, ranges, rng, pose);
    const Eigen::VectorXd dir = previous.size() == 0 ? Eigen::VectorXd::Ones(q.size()) : directions(previous, q);
    for (int shot = 0; shot < scene.repeats; ++shot) {
      const std::size_t row = table.samples.size();
      Sample sample;
      sample.image = fmt::format("images/{:04}.png", row);
      sample.q = q;
      sample.pose = pose;
      sample.stamp = kSecondsBetweenRows * static_cast<double>(row);
      sample.dir = dir;
      table.samples.push_back(std::move(sample));
    }
    previous = q;
    told.advance();
  }
  addDrivers(scene, table);
  return table;
}

std::vector<ImageCorners> trueCorners(const Scene& scene, const SampleTable& samples) {
  const Cell cell = trueCell(scene);
  const std::vector<Disturbance> disturbances = trueDisturbances(scene, samples.samples);
  std::vector<ImageCorners> images;
  for (std::size_t k = 0; k < samples.samples.size(); ++k) {
    const Sample& sample = samples.samples[k];
    const Disturbance& disturbance = disturbances[k];
    const auto px = disturbedCorners(cell, sample, scene.target.points, disturbance);
    ImageCorners image{.image = sample.image, .corners = {}};
    for (FaceSight& sight : sightOf(disturbedCamera(cell, disturbance), scene.target, disturbedTarget(cell, sample, disturbance))) {
      for (Corner& corner : sight.corners) {
        const auto index = static_cast<std::size_t>(scene.target.find(corner.id) - scene.target.points.data());
        sight.complete = sight.complete && px[index].has_value();
        corner.px = px[index].value_or(corner.px);
      }
      if (!sight.complete || !sight.readable() || !inPicture(scene.camera, sight.corners, 0.0)) continue;
      image.corners.insert(image.corners.end(), sight.corners.begin(), sight.corners.end());
    }
    std::sort(image.corners.begin(), image.corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
    images.push_back(std::move(image));
  }
  return images;
}

}  // namespace poecal
