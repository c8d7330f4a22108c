// joint_harmonic: the transmission errs several times a turn.
#include <cmath>

#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  constexpr Eigen::Index kOrder = 0, kSine = 1, kCosine = 2;
  const double q = reading(effect, context), order = parameters(kOrder);
  const double sine = std::sin(order * q), cosine = std::cos(order * q);
  double shape = i == kSine ? sine : cosine;
  if (i == kOrder) shape = q * (parameters(kSine) * cosine - parameters(kCosine) * sine);
  jointPort(effect, disturbance) += amount * shape;
}

}  // namespace

EffectKind jointHarmonic() {
  EffectKind kind;
  kind.name = "joint_harmonic";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"qK"};
  kind.parameters = {{"order", "", 0.0, ParameterRole::kOrder}, {"sine", "rad", 2e-4}, {"cosine", "rad", 2e-4}};
  kind.needs = {Need::kJoints, Need::kRevolute};
  kind.meaning = "the transmission errs several times a turn";
  kind.formula = "d_K = sine sin(order q_K) + cosine cos(order q_K), order >= 2";
  kind.confused_with = {"joint_eccentricity", "joint_scatter"};
  kind.separate = "angles closer together than pi / (2 order); a wrong order looks like scatter";
  kind.remedy = "map the joint against an outer encoder and correct its readings; replace a worn gear";
  kind.add_derivative = addDerivative;
  return kind;
}

}  // namespace poecal::kinds
