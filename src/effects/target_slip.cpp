// target_slip: the target moved on its mount at some time.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  if (i > 0) disturbance.grip(i - 1) += amount * hasHappened(context, parameters(0));
}

}  // namespace

EffectKind targetSlip() {
  EffectKind kind;
  kind.name = "target_slip";
  kind.place = PlaceKind::kTargetMount;
  kind.reach = Reach::kPose;
  kind.drivers = {"stamp"};
  kind.parameters = slipParameters(2e-3, 5e-4);
  kind.needs = {Need::kStamp};
  kind.meaning = "the target moved on its mount at some time";
  kind.formula = "T_far_target becomes exp(rx ry rz tx ty tz) T_far_target where stamp >= time";
  kind.confused_with = {"camera_slip", "joint_slip"};
  kind.separate = "varied orientations of the flange before and after";
  kind.remedy = "fasten the target; measure again";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
