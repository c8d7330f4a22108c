// joint_gain: the joint moves (1 + g) times what it reads.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  jointPort(effect, disturbance) += amount * reading(effect, context);
}

}  // namespace

EffectKind jointGain() {
  EffectKind kind;
  kind.name = "joint_gain";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"qK"};
  kind.parameters = {{"gain", "", 1e-3}};
  kind.needs = {Need::kJoints};
  kind.meaning = "the joint moves (1 + g) times what it reads";
  kind.formula = "d_K = gain q_K";
  kind.confused_with = {"joint_eccentricity", "joint_compliance"};
  kind.separate = "readings over the joint's whole range, more than a turn where it has one";
  kind.remedy = "check the gear ratio and the encoder's counts per turn that the controller is told";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
