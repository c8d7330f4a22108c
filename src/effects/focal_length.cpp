// focal_length: the focal length is wrong.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Camera& camera = *context.capture->cell.camera;
  disturbance.intrinsics.head<2>() += amount * Eigen::Vector2d(camera.fx, camera.fy);
}

}  // namespace

EffectKind focalLength() {
  EffectKind kind;
  kind.name = "focal_length";
  kind.place = PlaceKind::kCameraLens;
  kind.drivers = {"pixel"};
  kind.parameters = {{"scale", "", 2e-3}};
  kind.needs = {Need::kCamera};
  kind.meaning = "the focal length is wrong";
  kind.formula = "(1 + scale) (fx, fy)";
  kind.confused_with = {"corner_bias", "base_compliance"};
  kind.separate = "the target near and far";
  kind.remedy = "calibrate the camera again; lock the focus";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
