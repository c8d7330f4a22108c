// What a diagnosis says on one screen, and in whole.
#include <gmock/gmock.h>

#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

GapStage stage(const std::string& name, double px) {
  GapStage one;
  one.stage = name;
  one.errors.px.rms = px;
  one.excess = px;
  return one;
}

Finding finding(const std::string& effect, const std::string& location, const std::string& driver) {
  Finding one;
  one.effect = effect;
  one.location = location;
  one.driver = driver;
  one.probability = 1.0;
  one.remedy = "come to every pose from the same side";
  for (int k = 1; k <= 6; ++k) one.alternatives.push_back({"joint_gain", "joint:" + std::to_string(k), "q1", 0.01});
  return one;
}

/// Of two findings, with more beside them than a screen has room for.
Diagnosis crowded() {
  Diagnosis diagnosis;
  diagnosis.pixels = true;
  diagnosis.findings = {finding("joint_eccentricity", "joint:6", "q6"), finding("joint_backlash", "joint:2", "dir2")};
  diagnosis.stages = {stage("nominal", 3.1), stage("registered", 3.1), stage("identified", 0.2),
                      stage("identified + joint_eccentricity@joint:6", 0.15),
                      stage("identified + joint_eccentricity@joint:6 + joint_backlash@joint:2", 0.1)};
  for (int k = 0; k < 20; ++k) diagnosis.findings[0].images.push_back("images/" + std::to_string(k) + ".png");
  for (const char* effect : {"rolling_shutter", "time_offset", "target_layout", "joint_offset", "joint_drift"}) {
    for (const char* place : {"joint:1", "joint:2", "joint:3"})
      diagnosis.not_testable.push_back({effect, place, std::string("no ") + place});
  }
  return diagnosis;
}

/// Rows of a terminal of 100 columns.
std::size_t rowsOf(const std::string& text) {
  std::size_t rows = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    rows += std::max<std::size_t>(1, (end - begin + 99) / 100);
    begin = end + 1;
  }
  return rows;
}

TEST(DiagnosisText, OnAScreenIsShortAndSaysWhereTheRestIs) {
  const std::string text = diagnosisText(crowded(), {}, TextLength::kScreen);
  // The steps before take 10 rows of 40 and more; lists that all overflow are the worst case.
  EXPECT_LE(rowsOf(text), 32u) << text;
  EXPECT_LT(rowsOf(text), rowsOf(diagnosisText(crowded(), {})));
  EXPECT_THAT(text, AllOf(HasSubstr("images/2.png\n         and 17 more, see diagnosis.json\n"), Not(HasSubstr("images/3.png"))));
  EXPECT_THAT(text, AllOf(HasSubstr("or joint_gain at joint:3"), HasSubstr("and 3 more, see diagnosis.json\n"),
                          Not(HasSubstr("or joint_gain at joint:4"))));
  EXPECT_THAT(text, HasSubstr("    ... + joint_backlash@joint:2      rms"));
  EXPECT_THAT(text, HasSubstr("    ... + joint_eccentricity@joint:6  rms"));
  EXPECT_THAT(text, HasSubstr("\n  not tested everywhere: rolling_shutter, time_offset, target_layout and 1 more, see diagnosis.json\n"));
}

TEST(DiagnosisText, InWholeLeavesNoExplanationOut) {
  const std::string text = diagnosisText(crowded(), {});
  EXPECT_THAT(text, AllOf(HasSubstr("or joint_gain at joint:6"), HasSubstr("images/9.png\n         and 10 more, see diagnosis.json\n")));
  EXPECT_THAT(text, HasSubstr("identified + joint_eccentricity@joint:6 + joint_backlash@joint:2  rms"));
  EXPECT_THAT(text, HasSubstr("  not tested: rolling_shutter at joint:1 (no joint:1)\n"));
  EXPECT_THAT(text, HasSubstr("  and 6 more that this capture cannot test, see diagnosis.json\n"));
}

TEST(DiagnosisText, OfWhatAllCouldBeTestedSaysNothing) {
  Diagnosis diagnosis = crowded();
  diagnosis.not_testable.clear();
  EXPECT_THAT(diagnosisText(diagnosis, {}, TextLength::kScreen), Not(HasSubstr("not tested")));
}

}  // namespace
}  // namespace poecal
