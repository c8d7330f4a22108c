// camera_slip: the camera or the base moved at some time.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  if (i > 0) disturbance.mount(i - 1) += amount * hasHappened(context, parameters(0));
}

}  // namespace

EffectKind cameraSlip() {
  EffectKind kind;
  kind.name = "camera_slip";
  kind.place = PlaceKind::kCameraMount;
  kind.reach = Reach::kPose;
  kind.drivers = {"stamp"};
  kind.parameters = slipParameters(1e-3, 1e-3);
  kind.needs = {Need::kStamp};
  kind.meaning = "the camera or the base moved at some time";
  kind.formula = "T_camera_near becomes exp(rx ry rz tx ty tz) T_camera_near where stamp >= time";
  kind.confused_with = {"camera_drift", "target_slip", "joint_slip"};
  kind.separate = "a tag that never moves in view tells a moved camera from a moved base";
  kind.remedy = "fasten the camera and the base; measure again";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
