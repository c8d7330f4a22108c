// joint_scatter: the joint comes to rest at random beyond its repeatability.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDraw(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) {
  jointPort(effect, disturbance) += parameters(0) * drawsOf(parameters(1), context).normal();
}

}  // namespace

EffectKind jointScatter() {
  EffectKind kind;
  kind.name = "joint_scatter";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"none"};
  kind.parameters = {{"sigma", "rad", 2e-4, ParameterRole::kSpread}, {"seed", "", 0.0, ParameterRole::kSeed}};
  kind.needs = {Need::kJoints};
  kind.meaning = "the joint comes to rest at random beyond its repeatability";
  kind.formula = "d_K = sigma n, n standard normal and new at each sample";
  kind.confused_with = {"joint_harmonic", "bad_samples"};
  kind.separate = "angles closer together: an unknown gear's order looks random where the poses do not resolve it";
  kind.remedy = "look for stick-slip, a loose coupling or a worn gear";
  kind.add_draw = addDraw;
  return kind;
}

}  // namespace poecal::kinds
