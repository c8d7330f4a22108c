// corner_bias: edges are seen too far out or in by a fixed number of pixels, by ink, bloom or blur.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  for (std::size_t j = 0; j < context.points.size(); ++j) disturbance.pixels[j] += amount * context.points[j].px_outward;
}

}  // namespace

EffectKind cornerBias() {
  EffectKind kind;
  kind.name = "corner_bias";
  kind.place = PlaceKind::kDetector;
  kind.drivers = {"pixel"};
  kind.parameters = {{"outward", "px", 0.1}};
  kind.needs = {Need::kCamera, Need::kTags};
  kind.meaning = "edges are seen too far out or in by a fixed number of pixels, by ink, bloom or blur";
  kind.formula = "both edges that meet in a corner move out by `outward` px";
  kind.confused_with = {"focal_length", "target_scale"};
  kind.separate = "a board of several tags, seen near and far";
  kind.remedy = "expose less, focus, print on matt paper, refine the edges";
  kind.moves_points = true;
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
