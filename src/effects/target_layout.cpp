// target_layout: a tag or point is not placed as said.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Eigen::Vector3d shift = amount * Eigen::Vector3d::Unit(i - 1);
  for (std::size_t j = 0; j < context.points.size(); ++j) {
    if (context.points[j].id.tag == static_cast<int>(parameters(0))) disturbance.points[j] += shift;
  }
}

}  // namespace

EffectKind targetLayout() {
  EffectKind kind;
  kind.name = "target_layout";
  kind.place = PlaceKind::kTargetShape;
  kind.drivers = {"none"};
  kind.parameters = {{"tag", "", 0.0, ParameterRole::kTag}, {"dx", "m", 5e-4}, {"dy", "m", 5e-4}};
  kind.needs = {Need::kCamera, Need::kSeveralTags};
  kind.meaning = "a tag or point is not placed as said";
  kind.formula = "points of the tag move by (dx, dy, 0) in target";
  kind.confused_with = {"target_bend", "target_scale"};
  kind.separate = "views that show it together with the others";
  kind.remedy = "measure where the tags are, or print them on one sheet";
  kind.moves_points = true;
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
