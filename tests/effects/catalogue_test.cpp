#include "poecal/effects/catalogue.hpp"

#include <set>

#include <gmock/gmock.h>

#include "effects/rich_cell.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(Catalogue, IsTheContractsTable) {
  std::vector<std::string> rows;
  for (const EffectKind& kind : effectKinds()) {
    std::string row = kind.name + " " + kind.placePattern();
    for (const std::string& driver : kind.drivers) row += " " + driver;
    rows.push_back(row);
  }
  EXPECT_THAT(
      rows,
      ElementsAre("joint_gain joint:K qK", "joint_eccentricity joint:K qK", "joint_harmonic joint:K qK", "joint_compliance joint:K tauK",
                  "joint_backlash joint:K dirK", "joint_hysteresis joint:K dirK", "joint_coupling joint:K qJ", "joint_slip joint:K stamp",
                  "joint_drift joint:K stamp temperature", "axis_wobble joint:K qK", "link_bending link:K gravity",
                  "link_expansion link:K temperature stamp", "base_compliance base gravity", "camera_slip camera.mount stamp",
                  "camera_drift camera.mount stamp temperature", "lens_distortion camera.lens pixel", "focal_length camera.lens pixel",
                  "focal_drift camera.lens stamp temperature", "principal_point camera.lens pixel", "rolling_shutter camera.shutter dq",
                  "time_offset timing dq", "target_scale target.shape none", "target_anisotropy target.shape none",
                  "target_bend target.shape none", "target_layout target.shape none", "target_slip target.mount stamp",
                  "corner_bias detector pixel", "joint_scatter joint:K none", "bad_samples samples none"));
}

TEST(Catalogue, EveryKindExplainsItself) {
  for (const EffectKind& kind : effectKinds()) {
    for (const std::string& text : {kind.meaning, kind.formula, kind.separate, kind.remedy}) EXPECT_THAT(text, Not(IsEmpty())) << kind.name;
    for (const std::string& other : kind.confused_with) EXPECT_NE(findEffectKind(other), nullptr) << kind.name << " names " << other;
    for (const EffectParameter& parameter : kind.parameters) {
      const bool has_size = parameter.role == ParameterRole::kLinear || parameter.role == ParameterRole::kSpread;
      EXPECT_EQ(parameter.typical > 0.0, has_size) << kind.name << " " << parameter.name;
    }
  }
}

TEST(Catalogue, DriftsAreSmallerPerKelvinThanPerHour) {
  Rng rng = test::rngOfThisTest();
  const Cell cell = test::richCell(rng).cell;
  const auto of = [&cell](const char* driver) {
    return makeEffect({.effect = "link_expansion", .location = "link:2", .parameters = {}, .driver = driver}, cell).effect.parameters()[0];
  };
  EXPECT_EQ(of("stamp").unit, "1/h");
  EXPECT_EQ(of("temperature").unit, "1/K");
  // Steel and aluminium grow by 1.2e-5 and 2.3e-5 per kelvin.
  EXPECT_NEAR(of("temperature").typical, 2e-5, 1e-20);
  EXPECT_NEAR(of("stamp").typical, 2e-4, 1e-20);
}

std::string errorOf(const EffectSpec& spec) {
  Rng rng = test::rngOfThisTest();
  const test::RichCell rich = test::richCell(rng);
  try {
    makeEffect(spec, rich.cell);
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

TEST(MakeEffect, ErrorsNameWhatThereIs) {
  EXPECT_THAT(errorOf({.effect = "joint_wear", .location = "joint:1"}),
              HasSubstr("effect 'joint_wear' is not known, expected joint_gain, "));
  EXPECT_EQ(errorOf({.effect = "joint_gain", .location = "joint:7"}), "joint_gain cannot be at 'joint:7', expected joint:1 to joint:6");
  EXPECT_THAT(errorOf({.effect = "joint_gain", .location = "link:1"}), HasSubstr("expected joint:1 to joint:6"));
  EXPECT_THAT(errorOf({.effect = "joint_gain", .location = "joint:2x"}), HasSubstr("cannot be at"));
  EXPECT_EQ(errorOf({.effect = "focal_length", .location = "lens"}), "focal_length cannot be at 'lens', expected camera.lens");
  EXPECT_EQ(errorOf({.effect = "axis_wobble", .location = "joint:2", .parameters = {{"tilt", 1.0}}}),
            "axis_wobble has no parameter 'tilt', expected sine_a, cosine_a, sine_b, cosine_b");
  EXPECT_EQ(errorOf({.effect = "joint_drift", .location = "joint:2", .parameters = {}, .driver = "q2"}),
            "joint_drift is not driven by 'q2', expected stamp or temperature");
  EXPECT_EQ(errorOf({.effect = "joint_slip", .location = "joint:2", .parameters = {{"offset", 1e-3}}}),
            "joint_slip needs its parameter 'time'");
  EXPECT_EQ(errorOf({.effect = "joint_coupling", .location = "joint:2", .parameters = {{"source", 2.0}}}),
            "joint_coupling: source is 2.0, expected the number of another joint");
}

TEST(MakeEffect, KnowsItsPlaceDriverAndUnits) {
  Rng rng = test::rngOfThisTest();
  const test::RichCell rich = test::richCell(rng);
  const AppliedEffect coupling = test::effectOf(rich, "joint_coupling", "joint:2", {{"source", 5.0}, {"ratio", 2e-3}});
  EXPECT_EQ(coupling.effect.location(), "joint:2");
  EXPECT_EQ(coupling.effect.driver().name(), "q5");
  EXPECT_THAT(coupling.parameters, test::IsNear(Eigen::Vector2d(5.0, 2e-3), 0.0));
  EXPECT_EQ(test::effectOf(rich, "joint_drift", "joint:1", {}).effect.parameters().front().unit, "rad/h");
  EXPECT_EQ(test::effectOf(rich, "joint_drift", "joint:4", {}, "temperature").effect.parameters().front().unit, "m/K") << "joint 4 slides";
  EXPECT_EQ(test::effectOf(rich, "joint_compliance", "joint:4", {}).effect.parameters().front().unit, "m/N");
}

TEST(MakeEffect, SpecMakesTheSameAgain) {
  Rng rng = test::rngOfThisTest();
  const test::RichCell rich = test::richCell(rng);
  for (const Effect& effect : candidateEffects(rich.cell, rich.target, rich.samples).effects) {
    Eigen::VectorXd parameters = effect.start();
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      const bool left_out = std::isnan(parameters(i));
      if (left_out || effect.parameters()[static_cast<std::size_t>(i)].role == ParameterRole::kLinear) {
        parameters(i) = rng.uniform(-1.0, 1.0);
      }
    }
    const AppliedEffect again = makeEffect(effect.spec(parameters), rich.cell);
    EXPECT_EQ(again.effect.driver(), effect.driver());
    EXPECT_EQ(again.effect.location(), effect.location());
    EXPECT_THAT(again.parameters, test::IsNear(parameters, 0.0));
  }
}

/// "joint_backlash at joint:1: no dir1.. columns"
std::set<std::string> whyNot(const Candidates& candidates) {
  std::set<std::string> lines;
  for (const NotTestable& entry : candidates.not_testable) lines.insert(entry.effect + " at " + entry.location + ": " + entry.why);
  return lines;
}

TEST(Candidates, WhatTheCaptureLacksIsSaid) {
  Rng rng = test::rngOfThisTest();
  test::RichCell rich = test::richCell(rng, "RP");
  EXPECT_THAT(whyNot(candidateEffects(rich.cell, rich.target, rich.samples)),
              ElementsAre("axis_wobble at joint:2: the joint does not turn", "joint_eccentricity at joint:2: the joint does not turn",
                          "joint_harmonic at joint:2: the joint does not turn"));
  rich.samples[1].dq.resize(0);
  rich.samples[2].stamp.reset();
  for (Sample& sample : rich.samples) sample.dir.resize(0);
  const std::set<std::string> lines = whyNot(candidateEffects(rich.cell, rich.target, rich.samples));
  EXPECT_THAT(lines,
              testing::IsSupersetOf({"time_offset at timing: no dq1.. columns", "rolling_shutter at camera.shutter: no dq1.. columns",
                                     "joint_backlash at joint:2: no dir1.. columns", "camera_slip at camera.mount: no stamp column"}));
  rich.cell.arm->links.clear();
  EXPECT_THAT(whyNot(candidateEffects(rich.cell, rich.target, rich.samples)),
              testing::Contains("joint_hysteresis at joint:1: no dir1.. columns"));
  for (Sample& sample : rich.samples) sample.dir = Eigen::VectorXd::Ones(rich.cell.arm->jointCount());
  EXPECT_THAT(whyNot(candidateEffects(rich.cell, rich.target, rich.samples)),
              testing::Contains("joint_hysteresis at joint:1: no masses of the links"));
  EXPECT_FALSE(lines.contains("camera_drift at camera.mount: no stamp column")) << "the temperature still drives it";
}

TEST(Candidates, PosesOfAnInstrumentTellNothingOfPictures) {
  Rng rng = test::rngOfThisTest();
  test::RichCell rich = test::richCell(rng, "RRR");
  rich.cell.camera.reset();
  for (const Effect& effect : candidateEffects(rich.cell, Target{}, rich.samples).effects) {
    EXPECT_THAT(effect.location(), Not(testing::AnyOf("camera.lens", "camera.shutter", "target.shape", "detector"))) << effect.name();
    Disturbance disturbance = Disturbance::zero(rich.cell, 0);
    const auto capture = makeCaptureContext(rich.cell, Target{}, Eigen::Vector3d(0, 0, -9.8), rich.samples);
    Eigen::VectorXd parameters = Eigen::VectorXd::Ones(effect.start().size());
    parameters = (effect.start().array() != 0.0).select(effect.start(), parameters);
    effect.disturb(parameters, makeSampleContext(capture, rich.samples[0], 0, {}), disturbance);
    EXPECT_TRUE(disturbance.joints.allFinite() && disturbance.mount.allFinite()) << effect.name();
  }
}

TEST(Candidates, OneForEachPlaceDriverSourceAndTag) {
  Rng rng = test::rngOfThisTest();
  const test::RichCell rich = test::richCell(rng, "RRR");
  std::map<std::string, int> count;
  for (const Effect& effect : candidateEffects(rich.cell, rich.target, rich.samples).effects) ++count[effect.name()];
  EXPECT_EQ(count["joint_gain"], 3);
  EXPECT_EQ(count["joint_drift"], 6) << "by time and by temperature";
  EXPECT_EQ(count["joint_coupling"], 6) << "two sources each";
  EXPECT_EQ(count["target_layout"], 2) << "two tags";
  EXPECT_EQ(count["time_offset"], 1);
  EXPECT_EQ(count.size(), 29u);
}

}  // namespace
}  // namespace poecal
