// target_scale: the target is larger or smaller than said.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Eigen::Vector3d& center = context.capture->center_target;
  for (std::size_t j = 0; j < context.points.size(); ++j) disturbance.points[j] += amount * (context.points[j].p_target - center);
}

}  // namespace

EffectKind targetScale() {
  EffectKind kind;
  kind.name = "target_scale";
  kind.place = PlaceKind::kTargetShape;
  kind.drivers = {"none"};
  kind.parameters = {{"scale", "", 5e-3}};
  kind.needs = {Need::kCamera};
  kind.meaning = "the target is larger or smaller than said";
  kind.formula = "p + scale (p - centre)";
  kind.confused_with = {"focal_length", "joint_gain"};
  kind.separate = "nothing in pictures of one arm whose lengths are free: it then shows as an arm that grew; measure the target";
  kind.remedy =
      "measure the printed target with a calliper and say its true size; if that is as stated, the arm is larger or smaller than its file "
      "says";
  kind.moves_points = true;
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
