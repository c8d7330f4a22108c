// target_anisotropy: the target is stretched along one axis.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const double center = context.capture->center_target.x();
  for (std::size_t j = 0; j < context.points.size(); ++j) disturbance.points[j].x() += amount * (context.points[j].p_target.x() - center);
}

}  // namespace

EffectKind targetAnisotropy() {
  EffectKind kind;
  kind.name = "target_anisotropy";
  kind.place = PlaceKind::kTargetShape;
  kind.drivers = {"none"};
  kind.parameters = {{"stretch", "", 2e-3}};
  kind.needs = {Need::kCamera};
  kind.meaning = "the target is stretched along one axis";
  kind.formula = "x of every point grows by stretch (x - centre)";
  kind.confused_with = {"target_bend", "lens_distortion"};
  kind.separate = "the target at several turns about its own normal";
  kind.remedy = "print again with the printer's scaling off, or measure both sides and say them";
  kind.moves_points = true;
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
