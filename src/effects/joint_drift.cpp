// joint_drift: the joint's zero wanders.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  jointPort(effect, disturbance) += amount * drifted(effect, parameters, context);
}

}  // namespace

EffectKind jointDrift() {
  EffectKind kind;
  kind.name = "joint_drift";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"stamp", "temperature"};
  kind.parameters = {{"rate", "rad/t", 2e-4}, driftReference()};
  kind.needs = {Need::kJoints};
  kind.meaning = "the joint's zero wanders";
  kind.formula = "d_K = rate t, t in hours since the reference (the first sample) or kelvin above it";
  kind.confused_with = {"joint_slip", "camera_drift", "link_expansion"};
  kind.separate = "a log of the temperature, a way back down with it, poses in an order unlike time's";
  kind.remedy = "warm the arm up before work, or correct the zero by temperature";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
