// joint_compliance: the joint yields to gravity's torque.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const auto k = static_cast<Eigen::Index>(effect.index());
  jointPort(effect, disturbance) +=
      amount * (effect.byMasses() ? context.torqueByMasses(effect.index(), massTerm(effect, i, context).column()) : context.torque(k));
}

void addByMasses(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) {
  const auto k = static_cast<Eigen::Index>(effect.index());
  jointPort(effect, disturbance) += context.joint_twists.col(k).dot(wrenchByMasses(effect, parameters, context));
}

}  // namespace

EffectKind jointCompliance() {
  EffectKind kind;
  kind.name = "joint_compliance";
  kind.place = PlaceKind::kJoint;
  kind.reach = Reach::kJoint;
  kind.drivers = {"tauK"};
  kind.parameters = {{"compliance", "rad/(N m)", 2e-5}};
  kind.needs = {Need::kJoints};
  kind.meaning = "the joint yields to gravity's torque";
  kind.formula = "d_K = compliance tau_K";
  kind.confused_with = {"base_compliance", "link_bending", "joint_gain", "joint_eccentricity"};
  kind.separate = "the same poses with a second payload: geometry stays, compliance grows with the load";
  kind.remedy = "compensate gravity's torque in the controller with this compliance; check the drive's tension and bearings";
  kind.add_derivative = addDerivative;
  kind.add_by_masses = addByMasses;
  kind.yields_to_gravity = true;
  return kind;
}

}  // namespace poecal::kinds
