#include "poecal/diagnosis/diagnose.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "diagnosis/small_cell.hpp"
#include "poecal/core/error.hpp"
#include "poecal/effects/sample_context.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kPoses = 60;
constexpr double kSigma = 0.1;  // [px]

TEST(Diagnose, NothingIsFoundWhereNothingIs) {
  const Diagnosis diagnosis = test::smallCell(1, kPoses, kSigma, {}).diagnosis();
  EXPECT_THAT(diagnosis.findings, IsEmpty());
  // 60 poses of 8 numbers, 36 unknowns: sigma is known to 3.4 %, three times that.
  EXPECT_NEAR(diagnosis.noise_sigma, kSigma, 0.1 * kSigma);
  EXPECT_EQ(diagnosis.shrinkage.value, 0.0);
}

struct Cause {
  const char* name;
  EffectSpec spec;
  const char* parameter;
};

class EachCause : public ::testing::TestWithParam<Cause> {};

TEST_P(EachCause, IsNamedWithItsSize) {
  const Cause& cause = GetParam();
  const Diagnosis diagnosis = test::smallCell(2, kPoses, kSigma, {cause.spec}).diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  const Finding& found = diagnosis.findings.front();
  EXPECT_EQ(found.effect, cause.spec.effect);
  EXPECT_EQ(found.location, cause.spec.location);
  // One draw of one seed: four of its own standard deviations.
  EXPECT_NEAR(found.parameters.at(cause.parameter), cause.spec.parameters.at(cause.parameter),
              4.0 * found.standard_deviation.at(cause.parameter));
  EXPECT_GT(found.probability, 0.9);
  EXPECT_LT(found.p_value, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    All, EachCause,
    ::testing::Values(Cause{"Gain", {"joint_gain", "joint:3", {{"gain", 2e-3}}}, "gain"},
                      Cause{"Backlash", {"joint_backlash", "joint:1", {{"half_gap", 2e-4}}}, "half_gap"},
                      Cause{"Hysteresis", {"joint_hysteresis", "joint:2", {{"lag", 8e-6}}}, "lag"},
                      Cause{"Harmonic", {"joint_harmonic", "joint:1", {{"order", 100.0}, {"sine", 3e-4}, {"cosine", 0.0}}}, "sine"},
                      Cause{"Coupling", {"joint_coupling", "joint:6", {{"source", 5.0}, {"ratio", 4e-3}}}, "ratio"},
                      Cause{"Focal", {"focal_length", "camera.lens", {{"scale", 0.01}}}, "scale"},
                      Cause{"Stretch", {"target_anisotropy", "target.shape", {{"stretch", 0.004}}}, "stretch"},
                      Cause{"CameraSlip", {"camera_slip", "camera.mount", {{"time", 905.0}, {"rx", 4e-4}, {"ty", 4e-4}}}, "rx"}),
    [](const auto& instance) { return std::string(instance.param.name); });

/// Readings as a logger with two decimals writes them.
Eigen::VectorXd twoDecimals(const Eigen::VectorXd& q) { return (100.0 * q).array().round() / 100.0; }

TEST(Diagnose, ReadingsThatWereRoundedAreNoiseAndNoEffect) {
  test::SmallCell small = test::smallCell(8, kPoses, kSigma, {});
  double squares = 0.0, corners = 0.0;
  for (Observation& observation : small.observations) {
    Sample& sample = small.samples[observation.sample];
    Sample rounded = sample;
    rounded.q = twoDecimals(sample.q);
    const Disturbance none = Disturbance::zero(small.cell, small.target.points.size());
    const auto stands = disturbedCorners(small.cell, sample, small.target.points, none);
    const auto read = disturbedCorners(small.cell, rounded, small.target.points, none);
    for (std::size_t j = 0; j < stands.size(); ++j) squares += (*read[j] - *stands[j]).squaredNorm();
    corners += static_cast<double>(stands.size());
    sample.q = observation.q = rounded.q;
  }
  const Diagnosis diagnosis = small.diagnosis();
  EXPECT_THAT(diagnosis.findings, IsEmpty());
  EXPECT_FALSE(diagnosis.gap_remains);
  // 360 draws beside 36 unknowns: known to 4 %, four times that.
  EXPECT_NEAR(diagnosis.noise_rms / std::sqrt(squares / corners), 1.0, 0.16);
  EXPECT_NEAR(diagnosis.noise_sigma, kSigma, 0.1 * kSigma) << "of the corners, beside it";
}

TEST(Diagnose, JointsThatMissTheirReadingsByMoreThanAnyArmLeaveAGap) {
  Rng rng = test::rngOfThisTest();
  test::SmallCell small = test::smallCell(12, kPoses, kSigma, {});
  constexpr double kMissed = 1.5e-3;  // [rad]
  for (Observation& observation : small.observations) {
    Sample& sample = small.samples[observation.sample];
    for (double& q : sample.q) q += kMissed * rng.normal();
    observation.q = sample.q;
  }
  const Diagnosis diagnosis = small.diagnosis();
  EXPECT_THAT(diagnosis.findings, IsEmpty());
  EXPECT_TRUE(diagnosis.gap_remains);
  EXPECT_FALSE(diagnosis.isClean());
  EXPECT_THAT(diagnosis.warnings, ::testing::Contains(HasSubstr("readings and pictures agree only to 1.")));
}

TEST(Diagnose, PicturesThatShookLeaveAGap) {
  Rng rng = test::rngOfThisTest();
  test::SmallCell small = test::smallCell(13, kPoses, kSigma, {});
  for (Observation& observation : small.observations) {
    const Eigen::Vector2d shift(rng.normal(), rng.normal());
    for (CornerMeasurement& corner : observation.corners) corner.px += shift;
  }
  const Diagnosis diagnosis = small.diagnosis();
  EXPECT_TRUE(diagnosis.gap_remains);
  EXPECT_THAT(diagnosis.warnings, ::testing::Contains(HasSubstr("the whole target lies 1.")));
}

// A joint that hardly turns is no mistake that a registration shows.
TEST(Diagnose, AJointBeforeWhichTheTargetIsMountedIsSaid) {
  test::SmallCell small = test::smallCell(14, kPoses, kSigma, {});
  for (Observation& observation : small.observations) {
    Sample& sample = small.samples[observation.sample];
    sample.q(5) *= 0.05;
    observation.q = sample.q;
  }
  test::observeWith(
      small, 5, [](const Eigen::VectorXd& q) { return -q(5); }, kSigma);
  EXPECT_THAT(small.diagnosis().warnings, ::testing::Contains(HasSubstr("joint:6 does not move what is seen")));
}

TEST(Diagnose, RoundFiguresThatWereCommandedAreNoNoise) {
  test::SmallCell small = test::smallCell(9, kPoses, kSigma, {});
  for (Observation& observation : small.observations) {
    Sample& sample = small.samples[observation.sample];
    sample.q = observation.q = twoDecimals(sample.q);
  }
  test::observeWith(
      small, 2, [](const Eigen::VectorXd& q) { return 2e-3 * q(2); }, kSigma);
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "joint_gain");
  EXPECT_EQ(diagnosis.findings.front().location, "joint:3");
  EXPECT_NEAR(diagnosis.findings.front().parameters.at("gain"), 2e-3, 4.0 * diagnosis.findings.front().standard_deviation.at("gain"));
  EXPECT_NEAR(diagnosis.noise_rms, std::sqrt(2.0) * kSigma, 0.1 * kSigma);
}

TEST(Diagnose, TagOfAnotherSizeIsSwallowedByLinksThatNoToleranceAllows) {
  const Diagnosis diagnosis = test::smallCell(3, kPoses, kSigma, {{"target_scale", "target.shape", {{"scale", 0.03}}}}).diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "target_scale");
  EXPECT_NEAR(diagnosis.findings.front().parameters.at("scale"), 0.03, 0.006);  // links of 0.4 m to 1 mm, four times
  EXPECT_FALSE(diagnosis.findings.front().shrinkage.claimed());
}

TEST(Diagnose, JointThatMovesAtRandomIsNoEffectOfItsPose) {
  const Diagnosis diagnosis =
      test::smallCell(4, kPoses, kSigma, {{"joint_scatter", "joint:2", {{"sigma", 3e-4}, {"seed", 5.0}}}}).diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "joint_scatter");
  EXPECT_EQ(diagnosis.findings.front().location, "joint:2");
  // A standard deviation from 60 draws: to 9 %, four times.
  EXPECT_NEAR(diagnosis.findings.front().parameters.at("sigma"), 3e-4, 0.36 * 3e-4);
}

// A constant deflection is a joint's zero, which the arm takes up: of masses that nobody stated it is no part of what is told.
TEST(Diagnose, DeflectionOfUnknownMassesIsToldBesideItsMean) {
  constexpr double kCompliance = 2e-4;  // [rad/(N m)]
  constexpr std::size_t kJoint = 2;
  test::SmallCell small = test::smallCell(100, kPoses, kSigma, {{"joint_compliance", "joint:3", {{"compliance", kCompliance}}}});
  const auto capture = makeCaptureContext(small.cell, small.target, {0.0, 0.0, -9.80665}, small.samples);
  Eigen::VectorXd deflections(static_cast<Eigen::Index>(small.samples.size()));
  for (std::size_t k = 0; k < small.samples.size(); ++k) {
    deflections(static_cast<Eigen::Index>(k)) = kCompliance * makeSampleContext(capture, small.samples[k], k, {}).torque(kJoint);
  }
  small.nominal.links.clear();
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1)) << diagnosisText(diagnosis, {});
  const Finding& found = diagnosis.findings.front();
  ASSERT_EQ(found.effect, "joint_compliance");
  ASSERT_EQ(found.location, "joint:3");
  const double beside = (deflections.array() - deflections.mean()).abs().maxCoeff();
  EXPECT_NEAR(*found.largest_deflection, beside, 4.0 * *found.largest_deflection_deviation);
  // As far from the whole of it, in deviations, as no chance is.
  EXPECT_GT(std::abs(*found.largest_deflection - deflections.array().abs().maxCoeff()), 8.0 * *found.largest_deflection_deviation);
}

TEST(Diagnose, CurveWithoutANameIsInTheModelAndServesPosesThatNobodySaw) {
  const EffectSpec bumps{.effect = "unknown",
                         .location = "joint:3",
                         .parameters = {{"low", -0.7}, {"high", 0.7}, {"c3", 4e-4}, {"c5", -4e-4}, {"c7", 4e-4}},
                         .driver = "q3"};
  const test::SmallCell whole = test::smallCell(11, 160, kSigma, {bumps});
  constexpr std::size_t kSeen = 80;
  test::SmallCell seen = whole;
  seen.samples.resize(kSeen);
  seen.observations.resize(kSeen);
  const Diagnosis diagnosis = seen.diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "unknown");
  EXPECT_EQ(diagnosis.findings.front().location, "joint:3");
  ASSERT_THAT(diagnosis.model.effects, SizeIs(1));
  Model without = diagnosis.model;
  without.effects.clear();
  EXPECT_GT(diagnosis.shrinkage.value, 0.5);
  // The noise of a point is that of both its numbers.
  const double noise = 2.0 * kSigma * kSigma, with = std::pow(whole.rmsOf(diagnosis.model, kSeen), 2);
  EXPECT_LT(with - noise, 0.25 * (std::pow(whole.rmsOf(without, kSeen), 2) - noise));
}

// One pose of 240 falls between a slip and the middle of the two pictures that it lies between: of 60 other poses, in one capture of five
// there is such a pose, off by all of the slip.
TEST(Diagnose, ShrinkageOfASlipAllowsForAPoseOnItsWrongSide) {
  const EffectSpec slip{"camera_slip", "camera.mount", {{"time", 905.0}, {"rx", 6e-3}, {"ty", 6e-3}}};
  const test::SmallCell small = test::smallCell(2, kPoses, kSigma, {slip});
  const auto before = static_cast<double>(
      std::count_if(small.samples.begin(), small.samples.end(), [](const Sample& sample) { return *sample.stamp < 905.0; }));
  const double share = before / kPoses;
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_GT(diagnosis.shrinkage.value, 0.95);
  // Who does not know of the slip is off by share (1 - share) of its square in the mean. Which poses fall into a sample of them scatters
  // that.
  const double one_pose = 1.0 / kPoses / (share * (1.0 - share));
  EXPECT_NEAR(diagnosis.shrinkage.interval.first, 1.0 - std::sqrt(one_pose), 0.1);
}

TEST(Diagnose, WildRowsAreListedAndNothingElse) {
  test::SmallCell small = test::smallCell(5, kPoses, kSigma, {});
  for (const std::size_t k : {std::size_t{7}, std::size_t{31}}) {
    for (CornerMeasurement& corner : small.observations[k].corners) corner.px.x() += 20.0 + 5.0 * corner.id.corner;
  }
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "bad_samples");
  ASSERT_THAT(diagnosis.bad_samples, SizeIs(2));
  EXPECT_EQ(diagnosis.bad_samples[0].sample, 7u);
  EXPECT_EQ(diagnosis.bad_samples[1].sample, 31u);
}

// Of so few poses each is held out alone: without the wild one there is a turn in which nothing judges.
TEST(Diagnose, OfFewPosesAWildOneIsListed) {
  test::SmallCell small = test::smallCell(5, 24, kSigma, {});
  for (CornerMeasurement& corner : small.observations[7].corners) corner.px.x() += 20.0 + 5.0 * corner.id.corner;
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_THAT(diagnosis.bad_samples, SizeIs(1));
  EXPECT_EQ(diagnosis.bad_samples[0].sample, 7u);
}

TEST(Diagnose, AWildShotGoesWithoutItsTwin) {
  test::SmallCell small = test::smallCell(5, 80, kSigma, {});
  // Every second row becomes another shot of the pose before it.
  Rng rng(9);
  for (std::size_t k = 0; k < small.samples.size(); ++k) {
    small.samples[k].pose = static_cast<long>(k / 2);
    if (k % 2 == 0) continue;
    small.samples[k].q = small.observations[k].q = small.observations[k - 1].q;
    small.samples[k].dir = small.samples[k - 1].dir;
  }
  test::observeWith(
      small, 0, [](const Eigen::VectorXd&) { return 0.0; }, kSigma);
  for (const std::size_t k : {std::size_t{14}, std::size_t{31}}) {
    for (CornerMeasurement& corner : small.observations[k].corners) corner.px.x() += 20.0 + 5.0 * corner.id.corner;
  }
  // Far less than a row of another pose, yet many times the noise.
  for (CornerMeasurement& corner : small.observations[52].corners) corner.px.y() += 0.7 * (corner.id.corner % 2 == 0 ? 1.0 : -1.0);
  const Diagnosis diagnosis = small.diagnosis();
  std::vector<std::size_t> bad;
  for (const BadSample& row : diagnosis.bad_samples) bad.push_back(row.sample);
  EXPECT_THAT(bad, ::testing::ElementsAre(14u, 31u, 52u));
}

// A lens a tenth off in its second radial term hardly moves a tag near the middle, and one in a corner of the picture by pixels: with
// corners good to 0.005 px such poses look as if they belonged to no model until the lens is known.
TEST(Diagnose, PosesThatAnEffectThrewFarComeBack) {
  const Diagnosis diagnosis =
      test::smallCell(5, kPoses, 0.005, {{"lens_distortion", "camera.lens", {{"dk1", 0.0}, {"dk2", 0.5}}}}).diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "lens_distortion");
  EXPECT_THAT(diagnosis.bad_samples, IsEmpty());
}

TEST(Diagnose, GravityThatPointsUpIsSaidAndNoLinkBendsAgainstIt) {
  const test::SmallCell small = test::smallCell(
      12, kPoses, kSigma, {{"joint_compliance", "joint:2", {{"compliance", 4e-5}}}, {"link_bending", "link:3", {{"compliance", 2e-5}}}});
  Cell stated = small.cell;
  stated.arm = small.nominal;
  Measurements measured = small.measurements();
  const auto yields = [](const Finding& finding) {
    return finding.effect != kUnknownEffect && effectKind(finding.effect).yields_to_gravity;
  };
  const Diagnosis down = diagnose(identify(stated, measured), measured);
  EXPECT_THAT(down.warnings, IsEmpty());
  EXPECT_TRUE(std::any_of(down.findings.begin(), down.findings.end(), yields));
  measured.gravity = -measured.gravity;
  const Diagnosis up = diagnose(identify(stated, measured), measured);
  ASSERT_THAT(up.warnings, SizeIs(1));
  EXPECT_THAT(up.warnings.front(), HasSubstr("it fits to gravity the other way round than gravity: [-0, -0, 9.80665]"));
  EXPECT_TRUE(std::none_of(up.findings.begin(), up.findings.end(), yields));
}

TEST(Diagnose, OneSidedPlayIsNotTestableAndSaysWhy) {
  test::SmallCell small = test::smallCell(6, kPoses, kSigma, {});
  for (Sample& sample : small.samples) sample.dir.setOnes();
  const Diagnosis diagnosis = small.diagnosis();
  EXPECT_THAT(diagnosis.findings, IsEmpty());
  for (int joint = 1; joint <= 6; ++joint) {
    const std::string place = "joint:" + std::to_string(joint);
    const auto found = std::find_if(diagnosis.not_testable.begin(), diagnosis.not_testable.end(),
                                    [&](const NotTestable& each) { return each.effect == "joint_backlash" && each.location == place; });
    ASSERT_NE(found, diagnosis.not_testable.end()) << place;
    EXPECT_THAT(found->why, HasSubstr("same side"));
  }
}

TEST(Diagnose, SameInputGivesTheSameBytes) {
  const test::SmallCell small = test::smallCell(7, 40, kSigma, {{"joint_gain", "joint:2", {{"gain", 2e-3}}}});
  EXPECT_EQ(diagnosisJson(small.diagnosis(), small.samples), diagnosisJson(small.diagnosis(), small.samples));
}

TEST(Diagnose, JsonHasTheWordsOfTheContract) {
  const test::SmallCell small = test::smallCell(8, 40, kSigma, {{"joint_gain", "joint:2", {{"gain", 2e-3}}}});
  const auto json = nlohmann::json::parse(diagnosisJson(small.diagnosis(), small.samples));
  EXPECT_EQ(json["format"], "poecal-diagnosis/1");
  EXPECT_EQ(json["verdict"], "effects");
  for (const char* key : {"noise", "gap", "findings", "where", "remaining", "detectable", "not_testable"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* key : {"stages", "before_excess_px", "after_excess_px", "shrinkage", "shrinkage_ci95"}) {
    EXPECT_TRUE(json["gap"].contains(key)) << key;
  }
  for (const char* key : {"effect", "location", "driver", "parameters", "standard_deviation", "units", "probability", "p_value",
                          "shrinkage", "shrinkage_ci95", "alternatives", "separate_with"}) {
    EXPECT_TRUE(json["findings"][0].contains(key)) << key;
  }
  EXPECT_EQ(json["gap"]["stages"][2]["stage"], "identified");
}

TEST(Diagnose, AGapWithoutACauseIsNotNothing) {
  Diagnosis diagnosis;
  EXPECT_THAT(diagnosisText(diagnosis, {}), HasSubstr("nothing beyond noise and geometry"));
  diagnosis.remaining_significant = true;
  diagnosis.remaining_location = "joint:4";
  diagnosis.remaining_driver = "q4";
  const std::string text = diagnosisText(diagnosis, {});
  EXPECT_THAT(text, ::testing::Not(HasSubstr("nothing")));
  EXPECT_THAT(text, HasSubstr("a gap, but no cause that helps on held-out poses"));
  EXPECT_THAT(text, HasSubstr("structure at joint:4, driven by q4"));
}

TEST(Diagnose, FewPosesAreSaid) {
  const test::SmallCell small = test::smallCell(9, 11, kSigma, {});
  EXPECT_THROW(small.diagnosis(), InsufficientData);
}

TEST(Diagnose, ExplainsAnEffectAtEachOfItsPlaces) {
  const Diagnosis diagnosis = test::smallCell(10, 40, kSigma, {{"joint_gain", "joint:2", {{"gain", 2e-3}}}}).diagnosis();
  const std::string text = explainEffect(diagnosis, "joint_gain");
  EXPECT_THAT(text, HasSubstr("found at joint:2"));
  EXPECT_THAT(text, HasSubstr("joint:5 driven by q5"));
  EXPECT_THROW(explainEffect(diagnosis, "joint_magic"), InvalidArgument);
}

}  // namespace
}  // namespace poecal
