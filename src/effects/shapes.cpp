#include "effects/shapes.hpp"

#include <string>

namespace poecal::kinds {

double reading(const Effect& effect, const SampleContext& context) { return context.sample.q(static_cast<Eigen::Index>(effect.index())); }

double& jointPort(const Effect& effect, Disturbance& disturbance) { return disturbance.joints(static_cast<Eigen::Index>(effect.index())); }

const Arm& armOf(const SampleContext& context) { return *context.capture->cell.arm; }

Vector6d rotationAbout(const Eigen::Vector3d& rotation, const Eigen::Vector3d& point) {
  Vector6d twist;
  twist << rotation, -rotation.cross(point);
  return twist;
}

Eigen::Matrix<double, 3, 2> acrossAxis(const Joint& joint) { return twistBasis(joint).topLeftCorner<3, 2>(); }

std::vector<EffectParameter> twistParameters(double rotation, double translation, const char* per) {
  std::vector<EffectParameter> parameters;
  for (const char* name : {"rx", "ry", "rz"}) parameters.push_back({name, std::string("rad") + per, rotation});
  for (const char* name : {"tx", "ty", "tz"}) parameters.push_back({name, std::string("m") + per, translation});
  return parameters;
}

std::vector<EffectParameter> slipParameters(double rotation, double translation) {
  std::vector<EffectParameter> parameters = twistParameters(rotation, translation, "");
  parameters.insert(parameters.begin(), {"time", "s", 0.0, ParameterRole::kTime});
  return parameters;
}

MassTerm massTerm(const Effect& effect, Eigen::Index i, const SampleContext& context) {
  return MassLayout(effect.index(), armOf(context).joints.size())[i];
}

Vector6d wrenchByMasses(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context, Eigen::Index way) {
  const MassLayout layout(effect.index(), armOf(context).joints.size());
  const Eigen::Index n = layout.perWay();
  return context.wrench_by_masses.rightCols(n) * parameters.segment(way * n, n);
}

EffectParameter driftReference() { return {"reference", "t", 0.0, ParameterRole::kReference}; }

double drifted(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context) {
  return context.elapsed(effect.driver().kind(), parameters(parameters.size() - 1));
}

double hasHappened(const SampleContext& context, double time) { return context.sample.stamp && *context.sample.stamp >= time ? 1.0 : 0.0; }

Rng drawsOf(double seed, const SampleContext& context) { return Rng(static_cast<std::uint64_t>(seed), context.number); }

}  // namespace poecal::kinds
