// focal_drift: the focal length changes.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Camera& camera = *context.capture->cell.camera;
  disturbance.intrinsics.head<2>() += amount * drifted(effect, parameters, context) * Eigen::Vector2d(camera.fx, camera.fy);
}

}  // namespace

EffectKind focalDrift() {
  EffectKind kind;
  kind.name = "focal_drift";
  kind.place = PlaceKind::kCameraLens;
  kind.drivers = {"stamp", "temperature"};
  kind.parameters = {{"rate", "1/t", 5e-4}, driftReference()};
  kind.needs = {Need::kCamera};
  kind.meaning = "the focal length changes";
  kind.formula = "(1 + rate t) (fx, fy), t in hours since the reference (the first sample) or kelvin above it";
  kind.confused_with = {"camera_drift", "link_expansion", "focal_length"};
  kind.separate = "a tag that never moves in view; a log of the temperature";
  kind.remedy = "turn off the autofocus, lock the zoom, let the camera warm up";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
