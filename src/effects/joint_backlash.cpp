// joint_backlash: the joint rests on either side of a gap, by where it came from.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  jointPort(effect, disturbance) += amount * context.sample.dir(static_cast<Eigen::Index>(effect.index()));
}

}  // namespace

EffectKind jointBacklash() {
  EffectKind kind;
  kind.name = "joint_backlash";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"dirK"};
  kind.parameters = {{"half_gap", "rad", 2e-4}};
  kind.needs = {Need::kJoints, Need::kDir};
  kind.meaning = "the joint rests on either side of a gap, by where it came from";
  kind.formula = "d_K = half_gap dir_K";
  kind.confused_with = {"joint_compliance"};
  kind.separate = "the same poses reached from both sides";
  kind.remedy = "come to every pose from the same side, preload or replace the gear";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
