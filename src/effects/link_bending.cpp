// link_bending: the link bends across its joint's axis under the moment that it carries.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index i, const Eigen::VectorXd&, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Joint& joint = armOf(context).joints[effect.index()];
  const Eigen::Matrix<double, 3, 2> across = acrossAxis(joint);
  const std::size_t k = effect.index();
  Eigen::Vector2d bending;
  if (effect.byMasses()) {
    const MassTerm term = massTerm(effect, i, context);
    bending = across.transpose() * context.momentByMasses(k, term.column());
    bending(1 - term.way) = 0.0;
  } else {
    bending = across.transpose() * context.moment_body.col(static_cast<Eigen::Index>(k));
    if (i == 1) bending.y() = -bending.y();
  }
  disturbance.links[k] += amount * rotationAbout(across * bending, joint.anchor);
}

void addByMasses(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) {
  const std::size_t k = effect.index();
  const Joint& joint = armOf(context).joints[k];
  const Eigen::Matrix<double, 3, 2> across = acrossAxis(joint);
  Eigen::Vector2d bending;
  for (Eigen::Index way = 0; way < 2; ++way) {
    bending(way) = across.col(way).dot(context.momentOf(wrenchByMasses(effect, parameters, context, way), k));
  }
  disturbance.links[k] += rotationAbout(across * bending, joint.anchor);
}

}  // namespace

EffectKind linkBending() {
  EffectKind kind;
  kind.name = "link_bending";
  kind.place = PlaceKind::kLink;
  kind.reach = Reach::kPose;
  kind.drivers = {"gravity"};
  kind.parameters = {{"compliance", "rad/(N m)", 5e-6}, {"difference", "rad/(N m)", 2e-6}};
  kind.needs = {Need::kJoints};
  kind.meaning = "the link bends across its joint's axis under the moment that it carries";
  kind.formula =
      "rotation of body K about its joint's anchor: (compliance + difference) (M . a) a + (compliance - difference) (M . b) b, a and b "
      "across the axis";
  kind.confused_with = {"joint_compliance", "base_compliance", "axis_wobble"};
  kind.separate = "a second payload; where the bending is about the next joint's axis it cannot be told from that joint's compliance";
  kind.remedy = "carry less, or correct the flange's pose by the load";
  kind.add_derivative = addDerivative;
  kind.add_by_masses = addByMasses;
  kind.yields_to_gravity = true;
  return kind;
}

}  // namespace poecal::kinds
