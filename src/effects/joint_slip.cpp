// joint_slip: the joint's zero moved at some time.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  if (i == 1) jointPort(effect, disturbance) += amount * hasHappened(context, parameters(0));
}

}  // namespace

EffectKind jointSlip() {
  EffectKind kind;
  kind.name = "joint_slip";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"stamp"};
  kind.parameters = {{"time", "s", 0.0, ParameterRole::kTime}, {"offset", "rad", 1e-3}};
  kind.needs = {Need::kJoints, Need::kStamp};
  kind.meaning = "the joint's zero moved at some time";
  kind.formula = "d_K = offset where stamp >= time";
  kind.confused_with = {"joint_drift", "camera_slip", "target_slip"};
  kind.separate = "poses repeated before and after; varied orientations of the flange";
  kind.remedy = "fasten the coupling or the encoder and set the joint's zero again";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
