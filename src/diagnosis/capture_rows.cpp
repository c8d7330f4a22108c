#include "diagnosis/capture_rows.hpp"

#include <algorithm>

#include "poecal/effects/catalogue.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

std::vector<TargetPoint> pointsOf(const Observation& observation) {
  std::vector<TargetPoint> points;
  points.reserve(observation.corners.size());
  for (const CornerMeasurement& corner : observation.corners) points.push_back({corner.id, corner.p_target});
  return points;
}

/// Groups of which only what is asked for remains; all where nothing is asked.
const std::vector<std::vector<std::size_t>>& chosen(const MeasuredCell& measured, const std::vector<std::vector<std::size_t>>& groups) {
  return groups.empty() ? measured.groups : groups;
}

std::shared_ptr<const CaptureContext> contextOf(const MeasuredCell& measured, const ModelState& state) {
  return makeCaptureContext(state.cell.cell, measured.target, measured.gravity, measured.samples, measured.other_columns);
}

/// Points moved as the target is bent, pixels moved back, seen by the camera as it is disturbed.
PlainSight plainSight(const Cell& cell, const Observation& observation, const Disturbance& disturbance) {
  PlainSight plain{cell, observation};
  if (cell.camera) plain.cell.camera = disturbedCamera(cell, disturbance);
  for (std::size_t j = 0; j < observation.corners.size(); ++j) {
    plain.observation.corners[j].p_target += disturbance.points[j];
    plain.observation.corners[j].px -= disturbance.pixels[j];
  }
  return plain;
}

int rowsOf(const Observation& observation) { return observation.unitCount() * observation.unitSize(); }

/// Fills the rows of the observation whose context is there.
/// @return the derivative of its pose by the base parameters
PoseDerivative evaluateObservation(const MeasuredCell& measured, const ModelState& state, const ParameterLayout& layout,
                                   ObservationRows& part) {
  const Cell& cell = state.cell.cell;
  const Observation& observation = measured.observations[part.context.number];
  const Sample& sample = measured.samples[part.context.number];
  const bool camera = cell.camera.has_value();
  part.size = rowsOf(observation);
  part.unit_sigma.reserve(static_cast<std::size_t>(observation.unitCount()));
  for (int unit = 0; unit < observation.unitCount(); ++unit) {
    part.unit_sigma.push_back(observation.pose ? 1.0 / observation.pose->whitening(5, 5)
                                               : observation.corners[static_cast<std::size_t>(unit)].sigma_px);
  }
  PoseDerivative pose;
  if (state.effects.empty()) {
    part.ports = posePortJacobian(cell, sample);
    evaluateRows(cell, observation, part.ports.T_camera_target, camera, part.rows);
    pose = evaluatePose(state.cell, layout, observation, part.context.chain);
  } else {
    const Disturbance disturbance = disturbanceOf(state.effects, part.context);
    part.ports = posePortJacobian(cell, sample, disturbance);
    const PlainSight plain = plainSight(cell, observation, disturbance);
    evaluateRows(plain.cell, plain.observation, part.ports.T_camera_target, camera, part.rows);
    pose = evaluatePose(state.cell, layout, sample, disturbance);
  }
  part.R_camera_target = part.ports.T_camera_target.linear();
  return pose;
}

/// Effects that go with the arm's axes.
std::vector<AppliedEffect> followingAxes(const ModelState& state) {
  std::vector<AppliedEffect> some;
  for (const AppliedEffect& applied : state.effects) {
    if (applied.effect.kind().followsAxes()) some.push_back(applied);
  }
  return some;
}

/// (there - here) / step, of the joints, the links and the base.
Disturbance slope(Disturbance there, const Disturbance& here, double step) {
  there.joints = (there.joints - here.joints) / step;
  for (std::size_t k = 0; k < there.links.size(); ++k) there.links[k] = (there.links[k] - here.links[k]) / step;
  there.base = (there.base - here.base) / step;
  return there;
}

/// Adds to J what the effects change by where the axes move: a line that something turns about, a link's length, gravity's lever arms.
/// With unknown masses, large moments that cancel each other make it some per cent of a column.
void addWhatFollowsAxes(const MeasuredCell& measured, const ModelState& state, const ParameterLayout& layout, CaptureRows& all) {
  const std::vector<AppliedEffect> effects = followingAxes(state);
  if (effects.empty()) return;
  constexpr double kStep = 1e-6;  // [rad], [m]: its square is below the rounding of the difference
  const bool load = std::any_of(effects.begin(), effects.end(), [](const AppliedEffect& one) { return one.effect.kind().takesLoad(); });
  std::vector<Disturbance> here;
  for (const ObservationRows& part : all.observations) here.push_back(disturbanceOf(effects, part.context));
  for (int i = 0; i < layout.twists; ++i) {
    const ModelState moved{state.cell.moved(layout, kStep * Eigen::VectorXd::Unit(layout.total, i)), {}};
    const auto capture = contextOf(measured, moved);
    for (std::size_t n = 0; n < all.observations.size(); ++n) {
      const ObservationRows& part = all.observations[n];
      const Disturbance there = disturbanceOf(effects, load ? part.context.loadOf(capture) : part.context.readingsOn(capture));
      all.J.col(i).segment(part.begin, part.size) += part.along(slope(there, here[n], kStep));
    }
  }
}

}  // namespace

MeasuredCell part(const MeasuredCell& measured, const std::vector<std::size_t>& numbers) {
  MeasuredCell some = measured;
  some.observations.clear();
  some.samples.clear();
  some.groups.clear();
  for (const std::size_t k : numbers) {
    some.observations.push_back(measured.observations[k]);
    some.samples.push_back(measured.samples[k]);
  }
  for (const std::vector<std::size_t>& group : measured.groups) {
    std::vector<std::size_t> members;
    for (const std::size_t k : group) {
      const auto at = std::lower_bound(numbers.begin(), numbers.end(), k);
      if (at != numbers.end() && *at == k) members.push_back(static_cast<std::size_t>(at - numbers.begin()));
    }
    if (!members.empty()) some.groups.push_back(members);
  }
  return some;
}

Eigen::VectorXd ObservationRows::along(const Disturbance& direction) const {
  Eigen::VectorXd motion = rows.H * ports.along(direction);
  if (rows.K.cols() > 0 && direction.intrinsics.size() > 0) motion += rows.K * direction.intrinsics;
  const bool corners = rows.unit_size == 2;
  for (std::size_t j = 0; corners && j < unit_sigma.size(); ++j) {
    if (!rows.valid[j]) continue;
    const auto row = 2 * static_cast<Eigen::Index>(j);
    if (!direction.points.empty()) motion.segment<2>(row) += rows.H.block<2, 3>(row, 3) * (R_camera_target * direction.points[j]);
    if (!direction.pixels.empty()) motion.segment<2>(row) += direction.pixels[j] / unit_sigma[j];
  }
  return motion;
}

int CaptureRows::groupSize(std::size_t g) const {
  int size = 0;
  for (const std::size_t k : groups[g]) size += observations[k].size;
  return size;
}

Eigen::VectorXd squareWeights(const CaptureRows& rows) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(rows.size());
  for (const ObservationRows& part : rows.observations) {
    const bool pose = part.rows.unit_size != 2;
    for (Eigen::Index n = pose && part.size == 6 ? 3 : 0; n < part.size; ++n) {
      const std::size_t unit = pose ? 0 : static_cast<std::size_t>(n / 2);
      if (part.rows.valid[unit]) weights(part.begin + n) = part.unit_sigma[unit] * part.unit_sigma[unit];
    }
  }
  return weights;
}

PlainSight plainSight(const MeasuredCell& measured, const ModelState& state, const ObservationRows& part) {
  return plainSight(state.cell.cell, measured.observations[part.context.number], disturbanceOf(state.effects, part.context));
}

CaptureRows captureRows(const MeasuredCell& measured, const ModelState& state, const std::vector<std::vector<std::size_t>>& groups) {
  const auto capture = contextOf(measured, state);
  const ParameterLayout layout(state.cell.cell, measured.free);
  const std::vector<std::vector<std::size_t>>& wanted = chosen(measured, groups);
  int size = 0;
  for (const std::vector<std::size_t>& group : wanted) {
    for (const std::size_t k : group) size += rowsOf(measured.observations[k]);
  }
  CaptureRows all;
  all.r.resize(size);
  all.J.resize(size, layout.total);
  all.observations.reserve(measured.observations.size());
  int begin = 0;
  for (const std::vector<std::size_t>& group : wanted) {
    all.groups.emplace_back();
    for (const std::size_t k : group) {
      all.groups.back().push_back(all.observations.size());
      ObservationRows& part = all.observations.emplace_back();
      part.begin = begin;
      part.context = makeSampleContext(capture, measured.samples[k], k, pointsOf(measured.observations[k]));
      const PoseDerivative pose = evaluateObservation(measured, state, layout, part);
      all.r.segment(begin, part.size) = part.rows.r;
      all.J.block(begin, 0, part.size, layout.pose_parameters) = part.rows.H * pose.M;
      if (layout.intrinsics >= 0) all.J.block(begin, layout.intrinsics, part.size, part.rows.K.cols()) = part.rows.K;
      begin += part.size;
    }
  }
  addWhatFollowsAxes(measured, state, layout, all);
  return all;
}

}  // namespace poecal
