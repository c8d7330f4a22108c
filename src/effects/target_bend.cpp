// target_bend: the target is not flat.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index i, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Eigen::Vector3d& center = context.capture->center_target;
  for (std::size_t j = 0; j < context.points.size(); ++j) {
    const Eigen::Vector3d p = context.points[j].p_target - center;
    const double shapes[] = {0.5 * p.x() * p.x(), 0.5 * p.y() * p.y(), p.x() * p.y()};
    disturbance.points[j].z() += amount * shapes[i];
  }
}

}  // namespace

EffectKind targetBend() {
  EffectKind kind;
  kind.name = "target_bend";
  kind.place = PlaceKind::kTargetShape;
  kind.drivers = {"none"};
  kind.parameters = {{"curvature_x", "1/m", 0.2}, {"curvature_y", "1/m", 0.2}, {"saddle", "1/m", 0.2}};
  kind.needs = {Need::kCamera};
  kind.meaning = "the target is not flat";
  kind.formula = "z + (curvature_x x^2 + curvature_y y^2) / 2 + saddle x y, x and y from its centre";
  kind.confused_with = {"target_anisotropy", "target_layout"};
  kind.separate = "tilted views; one tag shows its saddle alone";
  kind.remedy = "glue the target to a stiff flat plate";
  kind.moves_points = true;
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
