// joint_coupling: another joint's motion leaks into this one.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  // The source counts from 1, as joints do in files.
  jointPort(effect, disturbance) += amount * context.sample.q(static_cast<Eigen::Index>(parameters(0)) - 1);
}

}  // namespace

EffectKind jointCoupling() {
  EffectKind kind;
  kind.name = "joint_coupling";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"qJ"};
  kind.parameters = {{"source", "", 0.0, ParameterRole::kSource}, {"ratio", "", 1e-3}};
  kind.needs = {Need::kJoints};
  kind.meaning = "another joint's motion leaks into this one";
  kind.formula = "d_K = ratio q_source";
  kind.confused_with = {"joint_gain"};
  kind.separate = "poses in which the two joints do not move together";
  kind.remedy = "enter the coupling ratio of the wrist's gears in the controller";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
