// joint_hysteresis: the joint stops short by the wind-up of its gear under friction, which grows with the load.
#include <cmath>

#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

// Coulomb friction of a robot's gear grows linearly with the load torque, f = f_0 + f_tau |tau| (Bittencourt, Gunnarsson: Static Friction
// in a Robot Joint, J. Dyn. Sys., Meas., Control 134(5), 2012, eq. 11 ff.). At rest it holds the gear wound up by f / stiffness against the
// direction of approach. f_0 / stiffness is a joint_backlash; f_tau / stiffness is `lag`.
void addDerivative(const Effect& effect, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const auto k = static_cast<Eigen::Index>(effect.index());
  jointPort(effect, disturbance) -= amount * context.sample.dir(k) * std::abs(context.torque(k));
}

}  // namespace

EffectKind jointHysteresis() {
  EffectKind kind;
  kind.name = "joint_hysteresis";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"dirK"};
  kind.parameters = {{"lag", "rad/(N m)", 5e-6}};
  kind.needs = {Need::kJoints, Need::kDir, Need::kMasses};
  kind.meaning = "the joint stops short of where it was sent, by more under load";
  kind.formula = "d_K = -lag dir_K |tau_K|";
  kind.confused_with = {"joint_backlash", "joint_compliance"};
  kind.separate = "the same poses reached from both sides, with a second payload: backlash keeps its size, hysteresis grows with the load";
  kind.remedy = "come to every pose from the same side; check the gear's lubrication and preload";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
