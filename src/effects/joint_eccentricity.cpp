// joint_eccentricity: the reading errs once a turn, as of an encoder disc or a wheel off its centre.
#include <cmath>

#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const double q = reading(effect, context);
  jointPort(effect, disturbance) += amount * (i == 0 ? std::sin(q) : std::cos(q));
}

}  // namespace

EffectKind jointEccentricity() {
  EffectKind kind;
  kind.name = "joint_eccentricity";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"qK"};
  kind.parameters = {{"sine", "rad", 3e-4}, {"cosine", "rad", 3e-4}};
  kind.needs = {Need::kJoints, Need::kRevolute};
  kind.meaning = "the reading errs once a turn, as of an encoder disc or a wheel off its centre";
  kind.formula = "d_K = sine sin q_K + cosine cos q_K";
  kind.confused_with = {"joint_gain", "joint_compliance"};
  kind.separate = "readings over a whole turn; a second payload tells it from compliance";
  kind.remedy = "centre the encoder's disc or the output gear, or load a table of corrections into the controller";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
