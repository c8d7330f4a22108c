// lens_distortion: radial or tangential terms of the lens are missing or wrong.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index i, const Eigen::VectorXd&, const SampleContext&, double amount, Disturbance& disturbance) {
  constexpr Eigen::Index kFirstCoefficient = 4;  // fx fy cx cy stand before k1 k2 p1 p2
  disturbance.intrinsics(kFirstCoefficient + i) += amount;
}

}  // namespace

EffectKind lensDistortion() {
  EffectKind kind;
  kind.name = "lens_distortion";
  kind.place = PlaceKind::kCameraLens;
  kind.drivers = {"pixel"};
  kind.parameters = {{"dk1", "", 0.02}, {"dk2", "", 0.02}, {"dp1", "", 5e-4}, {"dp2", "", 5e-4}};
  kind.needs = {Need::kCamera, Need::kTangential};
  kind.meaning = "radial or tangential terms of the lens are missing or wrong";
  kind.formula = "k1 + dk1, k2 + dk2, p1 + dp1, p2 + dp2";
  kind.confused_with = {"principal_point", "focal_length"};
  kind.separate = "corners in the whole picture, its own corners too";
  kind.remedy = "calibrate the camera again with a board that fills the picture";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
