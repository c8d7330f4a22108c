#include "diagnosis/small_cell.hpp"

#include <algorithm>

#include "diagnosis/refit.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/geometry/se3.hpp"
#include "support/cameras.hpp"

namespace poecal::test {
namespace {

Arm spatialArm() {
  Arm arm;
  arm.name = "small";
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  arm.joints = {Joint::revolute("joint_1", z, {0.0, 0.0, 0.0}),   Joint::revolute("joint_2", y, {0.05, 0.0, 0.35}),
                Joint::revolute("joint_3", y, {0.05, 0.0, 0.75}), Joint::revolute("joint_4", x, {0.25, 0.0, 0.8}),
                Joint::revolute("joint_5", y, {0.45, 0.0, 0.8}),  Joint::revolute("joint_6", x, {0.5, 0.0, 0.8})};
  arm.gamma << 0.0, 0.0, 0.0, 0.55, 0.0, 0.8;
  arm.links = {{8.0, {0.0, 0.0, 0.2}},  {6.0, {0.05, 0.02, 0.55}}, {4.0, {0.15, 0.0, 0.78}},
               {2.0, {0.3, 0.01, 0.8}}, {1.0, {0.45, 0.0, 0.8}},   {0.5, {0.52, 0.0, 0.8}}};
  return arm;
}

Camera plainCamera() { return test::plumbBob(2448, 2048, {2400.0, 2400.0}, {1224.0, 1024.0}); }

}  // namespace

SmallCell smallCell(std::uint64_t seed, int poses, double sigma, const std::vector<EffectSpec>& effects) {
  Rng rng(seed);
  SmallCell small;
  small.nominal = spatialArm();
  Eigen::VectorXd beta(twistParameterCount(small.nominal));
  for (Eigen::Index k = 0; k < beta.size(); ++k) beta(k) = rng.normal() * (k % 4 < 2 ? 2e-3 : 5e-4);
  small.cell.arm = displaceTwists(small.nominal, beta);
  small.cell.camera = plainCamera();
  small.target = apriltagTarget("tag36h11", {{.id = 1, .size = 0.08}});
  Registration& registration = small.cell.registration;
  // The camera looks along -x of base at the flange from 1.3 m before it; the tag faces it.
  Eigen::Matrix3d R_base_camera;
  R_base_camera.col(0) = Eigen::Vector3d::UnitY();
  R_base_camera.col(1) = -Eigen::Vector3d::UnitZ();
  R_base_camera.col(2) = -Eigen::Vector3d::UnitX();
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  T_base_camera.linear() = R_base_camera;
  T_base_camera.translation() << 1.85, 0.0, 0.7;
  registration.T_camera_near = T_base_camera.inverse();
  registration.T_far_target.linear() = R_base_camera;
  registration.T_far_target.translation() << 0.03, 0.01, -0.02;
  while (static_cast<int>(small.samples.size()) < poses) {
    Sample sample;
    sample.q.resize(6);
    const double range[6] = {0.7, 0.6, 0.7, 1.2, 0.8, 1.5};
    for (Eigen::Index k = 0; k < 6; ++k) sample.q(k) = rng.uniform(-range[k], range[k]);
    const Eigen::Isometry3d T = registration.cameraTarget(forwardKinematics(*small.cell.arm, sample.q));
    const bool faces = T.linear()(2, 2) > 0.6;
    const bool inside = std::all_of(small.target.points.begin(), small.target.points.end(), [&](const TargetPoint& point) {
      const auto px = project(*small.cell.camera, T * point.p_target);
      return px && px->x() > 20.0 && px->x() < 2428.0 && px->y() > 20.0 && px->y() < 2028.0;
    });
    if (!faces || !inside) continue;
    sample.stamp = 30.0 * static_cast<double>(small.samples.size());
    sample.dir.resize(6);
    for (Eigen::Index k = 0; k < 6; ++k) sample.dir(k) = rng.uniform() < 0.5 ? -1.0 : 1.0;
    small.samples.push_back(sample);
  }
  std::vector<AppliedEffect> applied;
  for (const EffectSpec& spec : effects) applied.push_back(makeEffect(spec, small.cell));
  const std::vector<Disturbance> disturbances =
      disturbancesOf(applied, small.cell, small.target, {0.0, 0.0, -9.80665}, small.samples, true);
  for (std::size_t k = 0; k < small.samples.size(); ++k) {
    Observation observation{.sample = k, .q = small.samples[k].q, .T_base_flange = {}, .corners = {}, .pose = {}, .reference = {}};
    const auto px = disturbances[k].joints.size() > 0
                        ? disturbedCorners(small.cell, small.samples[k], small.target.points, disturbances[k])
                        : disturbedCorners(small.cell, small.samples[k], small.target.points, Disturbance::zero(small.cell, 4));
    for (std::size_t j = 0; j < px.size(); ++j) {
      const Eigen::Vector2d noise(rng.normal(), rng.normal());
      observation.corners.push_back(
          {.id = small.target.points[j].id, .p_target = small.target.points[j].p_target, .px = *px[j] + sigma * noise, .sigma_px = 1.0});
    }
    small.observations.push_back(observation);
  }
  return small;
}

ModelState nominalState(const MeasuredCell& measured) { return {CellState(measured.start, measured.free), {}}; }

Fitted fitted(const SmallCell& small) {
  Fitted made{small.measured(), {}};
  made.linear = refit(made.measured, nominalState(made.measured), {}, {}, NoiseEstimate{}, {}, true);
  return made;
}

Measurements SmallCell::measurements() const {
  Measurements measured;
  measured.target = target;
  measured.samples = samples;
  measured.observations = observations;
  return measured;
}

namespace {

Eigen::VectorXd moved(Eigen::VectorXd q, std::size_t k, const JointError& error) {
  const double off = error(q);
  q(static_cast<Eigen::Index>(k)) += off;
  return q;
}

}  // namespace

void observeWith(SmallCell& small, std::size_t k, const JointError& error, double sigma) {
  Rng rng(12345);
  for (Observation& observation : small.observations) {
    Sample stands = small.samples[observation.sample];
    stands.q = moved(stands.q, k, error);
    const auto px = disturbedCorners(small.cell, stands, small.target.points, Disturbance::zero(small.cell, small.target.points.size()));
    for (std::size_t j = 0; j < px.size(); ++j) {
      observation.corners[j].px = *px[j] + sigma * Eigen::Vector2d(rng.normal(), rng.normal());
    }
  }
}

void measurePoses(SmallCell& small, std::size_t k, const JointError& error, double sigma) {
  Rng rng(54321);
  for (Observation& observation : small.observations) {
    const Eigen::VectorXd q = moved(small.samples[observation.sample].q, k, error);
    Vector6d off;
    for (Eigen::Index i = 0; i < 6; ++i) off(i) = rng.normal() * (i < 3 ? 5.0 : 1.0) * sigma;
    PoseMeasurement pose;
    pose.T_camera_target = small.cell.registration.cameraTarget(forwardKinematics(*small.cell.arm, q)) * expSe3(off);
    Vector6d weight;
    weight << Eigen::Vector3d::Constant(1.0 / 3e-3), Eigen::Vector3d::Constant(1.0 / 1e-3);
    pose.whitening = weight.asDiagonal();
    observation.pose = pose;
    observation.corners.clear();
  }
  small.cell.camera.reset();
  small.target = {};
}

Diagnosis SmallCell::diagnosis() const {
  Cell stated = cell;
  stated.arm = nominal;
  const Measurements measured = measurements();
  return diagnose(identify(stated, measured), measured);
}

MeasuredCell SmallCell::measured() const {
  MeasuredCell made;
  made.start = cell;
  made.start.arm = nominal;
  made.free = {.twists = true, .near = true, .far = true};
  made.observations = observations;
  made.samples = samples;
  made.target = target;
  made.twists = TwistPrior(nominal, 1e-3, 3e-3);
  for (std::size_t k = 0; k < samples.size(); ++k) made.groups.push_back({k});
  return made;
}

SmallCell SmallCell::head(std::size_t poses) const {
  SmallCell some = *this;
  some.samples.resize(poses);
  some.observations.resize(poses);
  return some;
}

double SmallCell::rmsOf(const Model& model, std::size_t first) const {
  const std::vector<Sample> some(samples.begin() + static_cast<std::ptrdiff_t>(first), samples.end());
  const auto disturbances = disturbancesOf(model.effects, model.cell, target, {0.0, 0.0, -9.80665}, some);
  double squares = 0.0, points = 0.0;
  for (std::size_t k = 0; k < some.size(); ++k) {
    const Disturbance disturbance = model.effects.empty() ? Disturbance::zero(model.cell, target.points.size()) : disturbances[k];
    const auto px = disturbedCorners(model.cell, some[k], target.points, disturbance);
    for (std::size_t j = 0; j < px.size(); ++j, ++points) squares += (*px[j] - observations[first + k].corners[j].px).squaredNorm();
  }
  return std::sqrt(squares / points);
}

}  // namespace poecal::test
