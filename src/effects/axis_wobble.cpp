// axis_wobble: the axis tilts as it turns.
#include <cmath>

#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Joint& joint = armOf(context).joints[effect.index()];
  const double q = reading(effect, context);
  const double wave = i % 2 == 0 ? std::sin(q) : std::cos(q);
  const Vector6d twist = amount * wave * rotationAbout(acrossAxis(joint).col(i / 2), joint.anchor);
  // What stands before the joint is the body of the joint before it.
  (effect.index() == 0 ? disturbance.base : disturbance.links[effect.index() - 1]) += twist;
}

}  // namespace

EffectKind axisWobble() {
  EffectKind kind;
  kind.name = "axis_wobble";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kPose;
  kind.drivers = {"qK"};
  kind.parameters = {{"sine_a", "rad", 1e-4}, {"cosine_a", "rad", 1e-4}, {"sine_b", "rad", 1e-4}, {"cosine_b", "rad", 1e-4}};
  kind.needs = {Need::kJoints, Need::kRevolute};
  kind.meaning = "the axis tilts as it turns";
  kind.formula = "exp((sine_a a + sine_b b) sin q_K + (cosine_a a + cosine_b b) cos q_K) before the joint, a and b across its axis";
  kind.confused_with = {"link_bending", "joint_eccentricity"};
  kind.separate = "readings over the joint's whole range; a tilt that turns with the link cannot be told from geometry";
  kind.remedy = "replace or re-seat the joint's bearing";
  kind.add_derivative = addDerivative;
  kind.stands_on_axes = true;
  return kind;
}

}  // namespace poecal::kinds
