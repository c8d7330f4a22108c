// Every candidate of a cell: what it adds is what its derivative says.
#include <gmock/gmock.h>

#include "effects/rich_cell.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

/// Every number of a disturbance in one column.
Eigen::VectorXd flat(const Disturbance& disturbance) {
  std::vector<double> numbers(disturbance.joints.begin(), disturbance.joints.end());
  const auto add = [&numbers](const auto& vector) { numbers.insert(numbers.end(), vector.begin(), vector.end()); };
  for (const Vector6d& link : disturbance.links) add(link);
  add(disturbance.base);
  add(disturbance.mount);
  add(disturbance.grip);
  add(disturbance.intrinsics);
  for (const Eigen::Vector3d& point : disturbance.points) add(point);
  for (const Eigen::Vector2d& pixel : disturbance.pixels) add(pixel);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

class EffectDerivative : public ::testing::TestWithParam<bool> {};

TEST_P(EffectDerivative, MatchesCentralDifferencesOfWhatIsAdded) {
  // Disturbances are linear in all but the order, and of size 1 to 1e4: rounding 1e-12 / 1e-6 relative; the order's truncation is 1e-12.
  constexpr double kStep = 1e-6;
  constexpr double kRelative = 1e-8;
  Rng rng = test::rngOfThisTest();
  test::RichCell rich = test::richCell(rng);
  const bool masses_known = GetParam();
  if (!masses_known) rich.cell.arm->links.clear();
  rich.capture = makeCaptureContext(rich.cell, rich.target, rich.capture->gravity, rich.samples);
  const SampleContext context = rich.context(2);
  const Candidates candidates = candidateEffects(rich.cell, rich.target, rich.samples);
  ASSERT_GT(candidates.effects.size(), 70u);
  for (const Effect& effect : candidates.effects) {
    Eigen::VectorXd parameters = effect.start();
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      const EffectParameter& parameter = effect.parameters()[static_cast<std::size_t>(i)];
      if (parameter.role == ParameterRole::kLinear) parameters(i) = rng.uniform(-1.0, 1.0);
      if (parameter.role == ParameterRole::kOrder) parameters(i) = 2.7;
      if (parameter.name == "time") parameters(i) = *context.sample.stamp - 10.0;
    }
    const auto added = [&](const Eigen::VectorXd& values) {
      Disturbance disturbance = Disturbance::zero(rich.cell, context.points.size());
      effect.disturb(values, context, disturbance);
      return flat(disturbance);
    };
    bool moves_something = effect.kind().add_draw != nullptr;
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      if (isFixed(effect.parameters()[static_cast<std::size_t>(i)].role)) continue;
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(parameters.size(), i);
      const Eigen::VectorXd difference = (added(parameters + step) - added(parameters - step)) / (2.0 * kStep);
      Disturbance derivative = Disturbance::zero(rich.cell, context.points.size());
      effect.addDerivative(i, parameters, context, 1.0, derivative);
      EXPECT_THAT(flat(derivative), test::IsNear(difference, kRelative * (1.0 + difference.norm())))
          << effect.name() << " at " << effect.location() << ", parameter " << i;
      moves_something = moves_something || difference.norm() > 0.0;
    }
    EXPECT_TRUE(moves_something) << effect.name() << " at " << effect.location();
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, EffectDerivative, ::testing::Bool(),
                         [](const auto& parameter) { return std::string(parameter.param ? "WithMasses" : "WithoutMasses"); });

TEST(Reach, NothingIsMovedBeyondIt) {
  Rng rng = test::rngOfThisTest();
  const test::RichCell rich = test::richCell(rng);
  const SampleContext context = rich.context(2);
  for (const Effect& effect : candidateEffects(rich.cell, rich.target, rich.samples).effects) {
    Disturbance disturbance = Disturbance::zero(rich.cell, context.points.size());
    Eigen::VectorXd parameters = effect.start();
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      // A time long past, an order, a share of samples: at each of them the effect acts.
      if (!isFixed(effect.parameters()[static_cast<std::size_t>(i)].role)) parameters(i) = 1.5;
      effect.addDerivative(i, parameters, context, 1.0, disturbance);
    }
    effect.disturbAtRandom(parameters, context, disturbance);
    const Disturbance none = Disturbance::zero(rich.cell, context.points.size());
    if (effect.kind().reach == Reach::kPicture) continue;
    Disturbance beyond = disturbance;
    if (effect.kind().reach == Reach::kPose) {
      beyond.joints = none.joints;
      beyond.links = none.links;
      beyond.base = beyond.mount = beyond.grip = Vector6d::Zero();
    } else {
      beyond.joints(static_cast<Eigen::Index>(effect.index())) = 0.0;
    }
    EXPECT_EQ(flat(beyond).norm(), 0.0) << effect.name() << " at " << effect.location();
  }
}

TEST(SlipTime, MovesNothingUntilASampleIsPassed) {
  Rng rng = test::rngOfThisTest();
  const test::RichCell rich = test::richCell(rng);
  const AppliedEffect slip = test::effectOf(rich, "target_slip", "target.mount", {{"time", 500.0}, {"tx", 1e-3}});
  Disturbance derivative = Disturbance::zero(rich.cell, rich.target.points.size());
  slip.effect.addDerivative(slip.effect.parameterIndex("time"), slip.parameters, rich.context(3), 1.0, derivative);
  EXPECT_EQ(flat(derivative).norm(), 0.0);
}

}  // namespace
}  // namespace poecal
