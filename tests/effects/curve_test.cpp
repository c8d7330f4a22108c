#include "effects/curve.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "effects/rich_cell.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

constexpr double kRounding = 1e-12;
constexpr CurveRange kRange{-0.5, 1.5};

TEST(Curve, WavesAreCosinesThatStayAsTheyAreBeyondTheRange) {
  constexpr int kCount = 40;
  for (const double value : {-0.5, -0.31, 0.2, 1.0, 1.5}) {
    const Eigen::RowVectorXd waves = kRange.waves(value, kCount);
    for (int j = 1; j <= kCount; ++j) EXPECT_NEAR(waves(j - 1), std::cos(M_PI * j * (value + 0.5) / 2.0), kRounding) << value << " " << j;
  }
  EXPECT_EQ(kRange.waves(-7.0, kCount), kRange.waves(-0.5, kCount));
  EXPECT_EQ(kRange.waves(9.0, kCount), kRange.waves(1.5, kCount));
  EXPECT_TRUE(kRange.waves(std::nan(""), kCount).isZero(0.0));
}

class CurveAt : public ::testing::Test {
 protected:
  Disturbance of(const std::string& location, const std::string& driver, const Eigen::VectorXd& factors) const {
    const AppliedEffect curve = makeCurve(*Place::of(location), Driver(driver), kRange, factors, rich_.cell);
    return disturbanceOf({curve}, context_);
  }

  Rng rng_ = test::rngOfThisTest();
  test::RichCell rich_ = test::richCell(rng_);
  SampleContext context_ = rich_.context(1);
};

TEST_F(CurveAt, AJointIsTheSumOfItsWaves) {
  const Eigen::VectorXd factors = test::uniformVector(rng_, 5, 1e-3);
  const double q3 = context_.sample.q(2), tau2 = context_.torque(1);
  EXPECT_NEAR(of("joint:5", "q3", factors).joints(4), kRange.waves(q3, 5) * factors, kRounding);
  EXPECT_NEAR(of("joint:5", "tau2", factors).joints(4), kRange.waves(tau2, 5) * factors, kRounding);
  EXPECT_EQ(of("joint:5", "q3", factors).joints(3), 0.0);
}

TEST_F(CurveAt, AMountHasACurveForEachOfItsSixNumbers) {
  context_.sample.temperature = 0.7;
  const Eigen::VectorXd factors = test::uniformVector(rng_, 12, 1e-3);
  Vector6d expected;
  for (int axis = 0; axis < 6; ++axis) expected(axis) = kRange.waves(0.7, 2) * factors.segment<2>(2 * axis);
  EXPECT_THAT(of("camera.mount", "temperature", factors).mount, test::IsNear(expected, kRounding));
  EXPECT_THAT(of("target.mount", "temperature", factors).grip, test::IsNear(expected, kRounding));
}

TEST_F(CurveAt, AMountSwaysToAndFro) {
  context_.sample.stamp = 0.4;
  const double x = (0.4 + 0.5) / 2.0;  // of kRange
  const std::vector<double> cycles{1.5, 7.0};
  const Eigen::VectorXd factors = test::uniformVector(rng_, 24, 1e-3);
  Vector6d expected;
  for (int axis = 0; axis < 6; ++axis) {
    const auto of_axis = factors.segment<4>(4 * axis);
    expected(axis) = of_axis(0) * std::cos(3.0 * M_PI * x) + of_axis(1) * std::sin(3.0 * M_PI * x) +
                     of_axis(2) * std::cos(14.0 * M_PI * x) + of_axis(3) * std::sin(14.0 * M_PI * x);
  }
  const AppliedEffect made = makeSway({PlaceKind::kTargetMount}, Driver("stamp"), kRange, cycles, factors, rich_.cell);
  EXPECT_THAT(disturbanceOf({made}, context_).grip, test::IsNear(expected, kRounding));
  // As a file says it, it comes back.
  const AppliedEffect again = makeEffect(made.effect.spec(made.parameters), rich_.cell);
  EXPECT_EQ(again.parameters, made.parameters);
  EXPECT_THAT(disturbanceOf({again}, context_).grip, test::IsNear(expected, kRounding));
  EXPECT_THROW(makeSway({PlaceKind::kJoint, 1}, Driver("stamp"), kRange, cycles, factors, rich_.cell), InvalidArgument);
}

TEST_F(CurveAt, TheLensMovesPixelsByWhereTheyAre) {
  const Eigen::VectorXd factors = test::uniformVector(rng_, 2 * static_cast<int>(pixelOrders(3).size()), 0.5);
  const Disturbance disturbance = of("camera.lens", "pixel", factors);
  for (std::size_t point = 0; point < context_.points.size(); ++point) {
    const Eigen::Vector2d px = context_.points[point].px;
    Eigen::Vector2d expected = Eigen::Vector2d::Zero();
    Eigen::Index next = 0;
    for (const auto& [i, j] : pixelOrders(3)) {
      const double wave = std::cos(M_PI * i * px.x() / 1280.0) * std::cos(M_PI * j * px.y() / 1024.0);
      expected += wave * factors.segment<2>(next);
      next += 2;
    }
    EXPECT_THAT(disturbance.pixels[point], test::IsNear(expected, kRounding));
  }
}

TEST_F(CurveAt, AFurtherColumnIsFoundByItsName) {
  std::vector<Sample> samples = rich_.samples;
  for (Sample& sample : samples) sample.other = {7.0, 0.25};
  const Eigen::VectorXd factors = test::uniformVector(rng_, 3, 1e-3);
  const AppliedEffect curve = makeCurve({PlaceKind::kJoint, 0}, Driver("load"), kRange, factors, rich_.cell);
  const auto disturbances = [&](const std::vector<std::string>& columns) {
    return disturbancesOf({curve}, rich_.cell, rich_.target, rich_.capture->gravity, samples, false, columns);
  };
  EXPECT_NEAR(disturbances({"fan", "load"})[2].joints(0), kRange.waves(0.25, 3) * factors, kRounding);
  try {
    disturbances({"fan", "heater"});
    FAIL() << "a curve over a column that is not there";
  } catch (const InsufficientData& error) {
    EXPECT_THAT(error.what(), HasSubstr("unknown at joint:1 cannot be computed: sample 1 has no load"));
  }
}

TEST_F(CurveAt, ItsSpecMakesItAgain) {
  for (const auto& [location, driver, count] :
       {std::tuple("joint:2", "q2", 14), {"camera.mount", "stamp", 84}, {"target.mount", "stamp", 6}, {"camera.lens", "pixel", 54}}) {
    const AppliedEffect curve = makeCurve(*Place::of(location), Driver(driver), kRange, test::uniformVector(rng_, count, 1e-3), rich_.cell);
    const AppliedEffect again = makeEffect(curve.effect.spec(curve.parameters), rich_.cell);
    EXPECT_EQ(again.parameters, curve.parameters) << location;
  }
}

TEST_F(CurveAt, PlacesAndDriversThatCannotBeAreErrors) {
  const auto error_of = [this](const EffectSpec& spec) -> std::string {
    try {
      makeEffect(spec, rich_.cell);
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of({.effect = "unknown", .location = "base", .parameters = {}, .driver = "q1"}),
            "unknown cannot be at 'base', expected joint:K, camera.mount, target.mount or camera.lens");
  EXPECT_EQ(error_of({.effect = "unknown", .location = "joint:2", .parameters = {{"low", 0.0}, {"high", 1.0}}}),
            "unknown needs its driver");
  EXPECT_EQ(error_of({.effect = "unknown", .location = "joint:2", .parameters = {{"low", 0.0}, {"c1", 1.0}}, .driver = "q2"}),
            "unknown needs its parameter 'high'");
}

TEST(AngleWave, NamesReadBack) {
  for (const AngleWave& wave : {AngleWave{{0, 3.0}, {2, 2.0}, {3, -1.0}}, AngleWave{{5, 1.0}}, AngleWave{{1, -25.128}, {6, 4.0}}}) {
    const auto cosine = namedWave(cosineName(wave)), sine = namedWave(sineName(wave));
    ASSERT_TRUE(cosine && sine) << cosineName(wave);
    EXPECT_EQ(cosine->wave, wave);
    EXPECT_EQ(sine->wave, wave);
    EXPECT_FALSE(cosine->sine);
    EXPECT_TRUE(sine->sine);
  }
  EXPECT_EQ(cosineName({{0, 3.0}, {2, 2.0}, {3, -1.0}}), "cos(3q1+2q3-q4)");
  EXPECT_EQ(driversOf({{{3, 1.0}, {0, 2.0}}, {{2, -1.0}}}), "q1,q3,q4");
  for (const char* none : {"c1", "low", "cos()", "cos(q0)", "cos(3q1", "cos(3q1+2q1)", "cos(3x1)", "sin(0q1)", "tan(q1)", "cos(q1+)"}) {
    EXPECT_FALSE(namedWave(none)) << none;
  }
}

TEST_F(CurveAt, AJointFollowsWavesOfSeveralAngles) {
  const std::vector<AngleWave> waves{{{0, 3.0}, {2, 2.0}, {4, -4.0}}, {{1, 1.0}, {2, -1.0}}};
  const Eigen::VectorXd factors = test::uniformVector(rng_, 4, 1e-3);
  const AppliedEffect made = makeAngleWaves(1, waves, factors, rich_.cell);
  EXPECT_EQ(made.effect.driver().name(), "q1,q2,q3,q5");
  const Eigen::VectorXd& q = context_.sample.q;
  const double first = 3.0 * q(0) + 2.0 * q(2) - 4.0 * q(4), second = q(1) - q(2);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(q.size());
  expected(1) = factors(0) * std::cos(first) + factors(1) * std::sin(first) + factors(2) * std::cos(second) + factors(3) * std::sin(second);
  EXPECT_THAT(disturbanceOf({made}, context_).joints, test::IsNear(expected, kRounding));
  // As a file says it, it comes back.
  const AppliedEffect again = makeEffect(made.effect.spec(made.parameters), rich_.cell);
  EXPECT_EQ(again.parameters, made.parameters);
  EXPECT_THAT(disturbancesOf({again}, rich_.cell, rich_.target, rich_.capture->gravity, rich_.samples)[1].joints,
              test::IsNear(expected, kRounding));
  EXPECT_TRUE(hasDriver(made.effect.driver(), context_));
  EXPECT_FALSE(hasDriver(Driver("q1,q9"), context_));
}

}  // namespace
}  // namespace poecal
