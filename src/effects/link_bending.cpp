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
  const Eigen::Vector3d moment = effect.byMasses() ? context.momentByMasses(k, massColumn(effect, i, context))
                                                   : Eigen::Vector3d(context.moment_body.col(static_cast<Eigen::Index>(k)));
  Eigen::Vector2d bending = across.transpose() * moment;
  if (effect.byMasses()) {
    const bool about_b = 2 * i >= static_cast<Eigen::Index>(effect.parameters().size());
    bending(about_b ? 0 : 1) = 0.0;
  } else if (i == 1) {
    bending.y() = -bending.y();
  }
  disturbance.links[effect.index()] += amount * rotationAbout(across * bending, joint.anchor);
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
  kind.yields_to_gravity = true;
  return kind;
}

}  // namespace poecal::kinds
