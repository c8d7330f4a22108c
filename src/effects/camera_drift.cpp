// camera_drift: the camera's mount moves steadily.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  disturbance.mount(i) += amount * drifted(effect, parameters, context);
}

}  // namespace

EffectKind cameraDrift() {
  EffectKind kind;
  kind.name = "camera_drift";
  kind.place = PlaceKind::kCameraMount;
  kind.reach = Reach::kPose;
  kind.drivers = {"stamp", "temperature"};
  kind.parameters = twistParameters(5e-4, 5e-4, "/t");
  kind.parameters.push_back(driftReference());
  kind.meaning = "the camera's mount moves steadily";
  kind.formula =
      "T_camera_near becomes exp(t (rx ry rz tx ty tz)) T_camera_near, "
      "t in hours since the reference (the first sample) or kelvin above it";
  kind.confused_with = {"camera_slip", "focal_drift", "link_expansion"};
  kind.separate = "a tag that never moves in view; poses in an order unlike time's";
  kind.remedy = "stiffen the camera's mount and let it warm up";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
