// report.json: its figures are those of the other results, and its residuals those of the models.
#include "poecal/report/report.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "poecal/calibration/results.hpp"
#include "poecal/core/error.hpp"
#include "report/report_cells.hpp"
#include "report/verdict.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

using Json = nlohmann::json;

/// Figures of report.json have five digits, residuals four.
constexpr double kFiveDigits = 1e-4, kFourDigits = 1e-3;

const Json& withBacklash() {
  static const Json json = Json::parse(reportJson(test::runWithBacklash(), "../capture"));
  return json;
}

double rmsOfSizes(const Json& report, std::size_t model) {
  double squares = 0.0;
  for (const Json& sample : report["samples"]) squares += std::pow(sample["sizes"][model].get<double>(), 2);
  return std::sqrt(squares / static_cast<double>(report["samples"].size()));
}

TEST(Report, HoldsIdentificationAndDiagnosisAsTheirFilesDo) {
  const CalibrationRun& run = test::runWithBacklash();
  EXPECT_EQ(withBacklash()["identification"], Json::parse(identificationJson(*run.calibration.identification, run.measurements.samples)));
  EXPECT_EQ(withBacklash()["diagnosis"], Json::parse(diagnosisJson(run.calibration, run.measurements)));
}

TEST(Report, TheLadderIsThatOfTheDiagnosis) {
  const Diagnosis& diagnosis = *test::runWithBacklash().calibration.diagnosis;
  const Json& stages = withBacklash()["ladder"]["stages"];
  ASSERT_THAT(stages, SizeIs(diagnosis.stages.size()));
  for (std::size_t k = 0; k < diagnosis.stages.size(); ++k) {
    EXPECT_EQ(stages[k]["stage"], diagnosis.stages[k].stage);
    const double rms = stages[k]["rms"].get<double>();
    EXPECT_NEAR(rms, diagnosis.stages[k].rms, kFiveDigits * rms);
    EXPECT_LT(stages[k]["rms_ci95"][0].get<double>(), rms);
    EXPECT_GT(stages[k]["rms_ci95"][1].get<double>(), rms);
  }
}

// Every picture has four corners, so that the mean square over pictures is that over corners.
TEST(Report, ResidualsAreThoseThatTheIdentificationSums) {
  const Identification& identification = *test::runWithBacklash().calibration.identification;
  for (std::size_t stage = 0; stage < 3; ++stage) {
    const double expected = identification.stages[stage].calibration.px.rms;
    EXPECT_NEAR(rmsOfSizes(withBacklash(), stage), expected, kFourDigits * expected) << identification.stages[stage].name;
    EXPECT_NEAR(withBacklash()["models_rms"][stage].get<double>(), expected, kFiveDigits * expected);
  }
}

TEST(Report, ResidualsWithoutIntervalsAreOfTheSameModels) {
  const Json report = Json::parse(reportJson(test::identifiedOnly(), ""));
  EXPECT_TRUE(report["diagnosis"].is_null());
  EXPECT_THAT(report["ladder"]["stages"], SizeIs(3));
  EXPECT_EQ(report["models"], (Json{"nominal", "registered", "identified"}));
  EXPECT_EQ(report["samples"][5]["residuals"][2], withBacklash()["samples"][5]["residuals"][2]);
}

TEST(Report, TheCurveIsWhatTheFindingSays) {
  const Finding& finding = test::runWithBacklash().calibration.diagnosis->findings.at(0);
  ASSERT_EQ(finding.effect, "joint_backlash");
  const Json& points = withBacklash()["curves"][0]["points"];
  ASSERT_THAT(points["x"], SizeIs(60));
  double before = 0.0, after = 0.0;
  for (std::size_t k = 0; k < 60; ++k) {
    const double expected = 1e3 * finding.parameters.at("half_gap") * test::runWithBacklash().measurements.samples[k].dir(1);
    EXPECT_EQ(points["x"][k], test::runWithBacklash().measurements.samples[k].dir(1));
    EXPECT_NEAR(points["curve"][k].get<double>(), expected, kFourDigits * std::abs(expected));
    before += std::pow(points["before"][k].get<double>(), 2);
    after += std::pow(points["after"][k].get<double>(), 2);
  }
  // Corners of 0.1 px at 1.3 m tell a joint to some 0.03 mrad, a tenth of the play.
  EXPECT_LT(after, 0.05 * before);
}

// What the geometric model leaves of the play shows at its joint, with its sign; axes that are fitted take up a part of it.
TEST(Report, ErrorsOfAJointHaveTheSignOfWhatMovesIt) {
  const double play = 1e3 * test::runWithBacklash().calibration.diagnosis->findings.at(0).parameters.at("half_gap");
  double before = 0.0, after = 0.0;
  for (const Json& sample : withBacklash()["samples"]) {
    before += sample["dir"][1].get<double>() * sample["joint_errors"]["before"][1].get<double>() / 60.0;
    after += sample["dir"][1].get<double>() * sample["joint_errors"]["after"][1].get<double>() / 60.0;
  }
  EXPECT_GT(before, 0.5 * play);
  EXPECT_LT(before, 1.1 * play);
  EXPECT_LT(std::abs(after), 0.1 * play);
}

TEST(Report, AGapWithoutACauseIsNotNothing) {
  Calibration calibration;
  calibration.diagnosis.emplace();
  calibration.diagnosis->remaining_significant = true;
  calibration.diagnosis->remaining_location = "joint:4";
  calibration.diagnosis->remaining_driver = "q4";
  const Verdict verdict = verdictOf(calibration);
  EXPECT_EQ(verdict.headline, "A gap without a known cause");
  EXPECT_THAT(verdict.sentences, SizeIs(3));
  EXPECT_EQ(verdict.sentences.front(), "Structure is left at joint 4, driven by q4.");
  EXPECT_THAT(verdict.actions, SizeIs(2));
}

TEST(Report, WordsTheVerdictInThreeSentences) {
  for (const CalibrationRun& run : {test::runWithBacklash(), test::runWithout(), test::identifiedOnly(), test::runOfPoses()}) {
    const Json verdict = Json::parse(reportJson(run, ""))["verdict"];
    EXPECT_THAT(verdict["sentences"], SizeIs(3));
    EXPECT_THAT(verdict["actions"], SizeIs(::testing::Ge(1u)));
  }
  EXPECT_EQ(withBacklash()["verdict"]["sentences"][0], "The gap lies at joint 2, driven by dir2.");
  EXPECT_EQ(Json::parse(reportJson(test::runWithout(), ""))["verdict"]["headline"], "Nothing beyond noise and geometry");
}

TEST(Report, TheFindingsAreThoseThatTheirCellsHave) {
  const auto effects = [](const CalibrationRun& run) {
    std::vector<std::string> names;
    for (const Finding& finding : run.calibration.diagnosis->findings) names.push_back(finding.effect);
    return names;
  };
  EXPECT_THAT(effects(test::runWithCurve()), ::testing::ElementsAre("unknown", "bad_samples"));
  EXPECT_THAT(effects(test::runWithScatter()), ::testing::ElementsAre("joint_scatter"));
  EXPECT_THAT(effects(test::runWithout()), ::testing::IsEmpty());
}

TEST(Report, PosesOfAnInstrumentHaveMillimetres) {
  const Json report = Json::parse(reportJson(test::runOfPoses(), ""));
  EXPECT_EQ(report["pixels"], false);
  EXPECT_TRUE(report["camera"].is_null());
  EXPECT_THAT(report["samples"][0]["residuals"][0], SizeIs(6));
  const double expected = 1e3 * test::runOfPoses().calibration.identification->stages[2].calibration.position.rms;
  EXPECT_NEAR(rmsOfSizes(report, 2), expected, kFourDigits * expected);
}

TEST(Report, NothingIdentifiedIsNothingToReport) {
  CalibrationRun run = test::runWithBacklash();
  run.calibration.identification.reset();
  EXPECT_THAT([&] { reportJson(run, ""); }, ThrowsMessage<InvalidArgument>(HasSubstr("the arm was not identified")));
}

}  // namespace
}  // namespace poecal
