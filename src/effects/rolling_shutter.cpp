// rolling_shutter: rows of the picture are exposed one after another while the arm moves.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const double middle = 0.5 * (context.capture->cell.camera->height - 1);
  for (std::size_t j = 0; j < context.points.size(); ++j) {
    const PointContext& point = context.points[j];
    if (point.px.allFinite()) disturbance.pixels[j] += amount * (point.px.y() - middle) * point.px_velocity;
  }
}

}  // namespace

EffectKind rollingShutter() {
  EffectKind kind;
  kind.name = "rolling_shutter";
  kind.place = PlaceKind::kCameraShutter;
  kind.drivers = {"dq"};
  kind.parameters = {{"line_time", "s", 2e-5}};
  kind.needs = {Need::kCamera, Need::kJoints, Need::kDq};
  kind.meaning = "rows of the picture are exposed one after another while the arm moves";
  kind.formula = "a pixel in row v moves by (v - (height - 1) / 2) line_time d(pixel)/dt";
  kind.confused_with = {"time_offset"};
  kind.separate = "motion at several speeds, the target high and low in the picture";
  kind.remedy = "stop before each picture, use a global shutter or a flash";
  kind.moves_points = true;
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
