// time_offset: the joints were read earlier or later than the exposure.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect&, Eigen::Index, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  disturbance.joints += amount * context.sample.dq;
}

}  // namespace

EffectKind timeOffset() {
  EffectKind kind;
  kind.name = "time_offset";
  kind.place = PlaceKind::kTiming;
  kind.reach = Reach::kPose;
  kind.drivers = {"dq"};
  kind.parameters = {{"offset", "s", 5e-3}};
  kind.needs = {Need::kJoints, Need::kDq};
  kind.meaning = "the joints were read earlier or later than the exposure";
  kind.formula = "d = offset dq: the picture shows the arm `offset` after its reading";
  kind.confused_with = {"rolling_shutter"};
  kind.separate = "motion at several speeds both ways";
  kind.remedy = "trigger camera and encoders together, correct the stamps, or stop before each picture";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
