// principal_point: the principal point is wrong.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index i, const Eigen::VectorXd&, const SampleContext&, double amount, Disturbance& disturbance) {
  constexpr Eigen::Index kCx = 2;
  disturbance.intrinsics(kCx + i) += amount;
}

}  // namespace

EffectKind principalPoint() {
  EffectKind kind;
  kind.name = "principal_point";
  kind.place = PlaceKind::kCameraLens;
  kind.drivers = {"pixel"};
  kind.parameters = {{"dx", "px", 5.0}, {"dy", "px", 5.0}};
  kind.needs = {Need::kCamera};
  kind.meaning = "the principal point is wrong";
  kind.formula = "cx + dx, cy + dy";
  kind.confused_with = {"lens_distortion"};
  kind.separate = "corners in the whole picture, the camera's lens known well otherwise";
  kind.remedy = "calibrate the camera again; check that the picture is not cropped";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
