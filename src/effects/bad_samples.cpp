// bad_samples: single rows whose joints and picture do not belong together.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDraw(const Effect&, const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) {
  Rng rng = drawsOf(parameters(2), context);
  if (rng.uniform() >= parameters(0)) return;
  for (double& joint : disturbance.joints) joint += parameters(1) * rng.normal();
}

}  // namespace

EffectKind badSamples() {
  EffectKind kind;
  kind.name = "bad_samples";
  kind.place = PlaceKind::kSamples;
  kind.reach = Reach::kPose;
  kind.drivers = {"none"};
  kind.parameters = {
      {"share", "", 0.02, ParameterRole::kSpread}, {"sigma", "rad", 0.02, ParameterRole::kSpread}, {"seed", "", 0.0, ParameterRole::kSeed}};
  kind.needs = {Need::kJoints};
  kind.meaning = "single rows whose joints and picture do not belong together";
  kind.formula = "in a share of the rows every joint is off by sigma n, n standard normal";
  kind.confused_with = {"joint_scatter"};
  kind.separate = "the rows are listed one by one";
  kind.remedy = "look at the listed rows; leave them out or record them again";
  kind.add_draw = addDraw;
  return kind;
}

}  // namespace poecal::kinds
