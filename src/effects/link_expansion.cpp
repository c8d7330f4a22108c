// link_expansion: the link grows as it warms.
#include "effects/kinds.hpp"
#include "effects/shapes.hpp"

namespace poecal::kinds {
namespace {

void addDerivative(const Effect& effect, Eigen::Index, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                   Disturbance& disturbance) {
  const Arm& arm = armOf(context);
  const std::size_t next = effect.index() + 1;
  const Eigen::Vector3d end = next < arm.joints.size() ? arm.joints[next].anchor : Eigen::Vector3d(expSe3(arm.gamma).translation());
  disturbance.links[effect.index()].tail<3>() += amount * drifted(effect, parameters, context) * (end - arm.joints[effect.index()].anchor);
}

}  // namespace

EffectKind linkExpansion() {
  EffectKind kind;
  kind.name = "link_expansion";
  kind.place = PlaceKind::kLink;
  kind.reach = Reach::kPose;
  kind.drivers = {"temperature", "stamp"};
  kind.parameters = {{"expansion", "1/t", 2e-4}, driftReference()};
  kind.needs = {Need::kJoints};
  kind.meaning = "the link grows as it warms";
  kind.formula =
      "body K moves what it carries by expansion t (p_next - p_K), "
      "t in kelvin above the reference (the first sample's temperature) or hours since it, p the anchors of the joints";
  kind.confused_with = {"camera_drift", "focal_drift", "joint_drift"};
  kind.separate = "a tag that never moves in view, a log of the temperature, a way back down with it";
  kind.remedy = "warm the arm up before work; correct lengths by temperature";
  kind.add_derivative = addDerivative;
  kind.stands_on_axes = true;
  return kind;
}

}  // namespace poecal::kinds
