// base_compliance: the pedestal tilts with the arm's moment.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  if (effect.byMasses()) {
    disturbance.base.head<3>() += amount * context.wrench_by_masses.col(massTerm(effect, i, context).column()).head<3>();
  } else {
    disturbance.base.head<3>() += amount * context.base_moment;
  }
}

void addByMasses(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) {
  disturbance.base.head<3>() += wrenchByMasses(effect, parameters, context).head<3>();
}

}  // namespace

EffectKind baseCompliance() {
  EffectKind kind;
  kind.name = "base_compliance";
  kind.place = PlaceKind::kBase;
  kind.reach = Reach::kPose;
  kind.drivers = {"gravity"};
  kind.parameters = {{"compliance", "rad/(N m)", 5e-6}};
  kind.needs = {Need::kJoints};
  kind.meaning = "the pedestal tilts with the arm's moment";
  kind.formula = "rotation of the base about its origin: compliance M, M the moment of gravity on the arm";
  kind.confused_with = {"joint_compliance", "link_bending"};
  kind.separate = "poses that turn the stretched arm about the vertical; a tag on the pedestal";
  kind.remedy = "bolt or stiffen the pedestal";
  kind.add_derivative = addDerivative;
  kind.add_by_masses = addByMasses;
  kind.yields_to_gravity = true;
  return kind;
}

}  // namespace poecal::kinds
