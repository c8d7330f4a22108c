#include "planning/planned_cell.hpp"

#include <cmath>

#include "planning/pool.hpp"
#include "poecal/effects/catalogue.hpp"
#include "support/random.hpp"

namespace poecal::test {
namespace {

/// Identifies from cell.taken.
void identifyAgain(const Cell& nominal, PlannedCell& planned) {
  IdentifyOptions options = plainBundle();
  options.tolerance_position = planned.cell.tolerance_position;
  options.tolerance_rotation = planned.cell.tolerance_rotation;
  planned.identification = identify(nominal, planned.cell.taken, options);
  planned.cell.model = planned.identification.model;
  planned.cell.noise.corner = kSigma;
  planned.cell.arm_beyond_tolerance = planned.identification.arm_beyond_tolerance;
}

}  // namespace

PlannedCell plannedCell(const std::string& name, std::uint64_t seed, int poses) {
  const Simulated data = simulated(name, seed, poses, 0);
  PlannedCell planned;
  planned.truth = data.truth;
  planned.cell.nominal = data.nominal;
  planned.cell.target = data.target;
  planned.cell.tolerance_position = 6e-4;  // as simulated() draws them
  planned.cell.tolerance_rotation = 2e-3;
  planned.cell.robot_file = name;
  planned.cell.taken = data.measurements();
  for (const Observation& observation : data.calibration) {
    Sample sample;
    sample.q = observation.q;
    planned.cell.taken.samples.push_back(sample);
  }
  identifyAgain(data.nominal, planned);
  return planned;
}

PlannedCell withPictures(const PlannedCell& planned, const std::vector<PlannedPose>& poses, std::uint64_t seed) {
  PlannedCell next = planned;
  Rng rng(seed, 77);
  for (const PlannedPose& pose : poses) {
    Sample sample;
    sample.q = pose.q;
    std::vector<Corner> corners = predictCorners(planned.truth, planned.cell.target, forwardKinematics(*planned.truth.arm, pose.q));
    for (Corner& corner : corners) {
      corner.px += kSigma * normalVector(rng, 2);
      corner.sigma = kSigma;
    }
    next.cell.taken.addPicture(sample, corners);
  }
  next.cell.taken.groups.clear();
  for (std::size_t k = 0; k < next.cell.taken.observations.size(); ++k) next.cell.taken.groups.push_back({k});
  next.cell.taken.sigmas_stated = false;  // their scale is estimated, as in the first fit
  identifyAgain(planned.cell.nominal, next);
  return next;
}

PlanningCell withEffect(const PlannedCell& planned, const EffectSpec& spec) {
  PlanningCell cell = planned.cell;
  cell.model.effects = {makeEffect(spec, cell.model.cell)};
  const std::vector<Disturbance> disturbances =
      disturbancesOf(cell.model.effects, cell.model.cell, cell.target, cell.taken.gravity, cell.taken.samples);
  for (Observation& observation : cell.taken.observations) {
    const Sample& sample = cell.taken.samples[observation.sample];
    const auto moved = disturbedCorners(cell.model.cell, sample, cell.target.points, disturbances[observation.sample]);
    const auto still = disturbedCorners(cell.model.cell, sample, cell.target.points, {});
    for (std::size_t j = 0; j < observation.corners.size(); ++j) observation.corners[j].px += *moved[j] - *still[j];
  }
  return cell;
}

void addPictures(const Cell& truth, const EffectSpec& spec, const std::vector<PlannedPose>& poses, std::uint64_t seed, PlanningCell& cell) {
  Rng rng(seed, 78);
  std::vector<Sample> samples;
  for (const PlannedPose& pose : poses) samples.emplace_back().q = pose.q;
  const std::vector<Disturbance> disturbances = disturbancesOf({makeEffect(spec, truth)}, truth, cell.target, cell.taken.gravity, samples);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto px = disturbedCorners(truth, samples[k], cell.target.points, disturbances[k]);
    std::vector<Corner> corners;
    for (std::size_t j = 0; j < px.size(); ++j) {
      corners.push_back({.id = cell.target.points[j].id, .px = *px[j] + kSigma * normalVector(rng, 2), .sigma = kSigma});
    }
    cell.taken.addPicture(samples[k], corners);
  }
  cell.taken.groups.clear();
  for (std::size_t k = 0; k < cell.taken.observations.size(); ++k) cell.taken.groups.push_back({k});
}

std::vector<PlannedPose> randomPoses(const std::string& name, std::uint64_t seed, int count) {
  std::vector<PlannedPose> poses;
  for (const Observation& observation : simulated(name, seed, count, 0).calibration) poses.push_back({observation.q, {}});
  return poses;
}

double toolError(const PlannedCell& planned) {
  const PlanOptions options;
  const auto toolOf = [](const Cell& cell, const Eigen::VectorXd& q) -> Eigen::Vector3d {
    return cell.registration.cameraTarget(forwardKinematics(*cell.arm, q)).translation();
  };
  const std::vector<Sample> workspace = Pool(planned.cell, options).anywhere(200);
  double squares = 0.0;
  for (const Sample& sample : workspace)
    squares += (toolOf(planned.truth, sample.q) - toolOf(planned.cell.model.cell, sample.q)).squaredNorm();
  return std::sqrt(squares / static_cast<double>(workspace.size()));
}

}  // namespace poecal::test
