// Does the scorer count what it says it counts?
#include <gmock/gmock.h>

#include "withheld/injected_table.hpp"
#include "withheld/tables.hpp"

namespace withheld {
namespace {

Finding finding(const std::string& effect, const std::string& location, const std::string& driver) {
  Finding made;
  made.effect = effect;
  made.location = location;
  made.driver = driver;
  made.probability = 0.9;
  return made;
}

Truth yieldingElbow() {
  Truth truth;
  truth.set = "single";
  truth.effects = {{"joint_compliance", "joint:3", "tau3", true, 15.0, 0.0, 0.0, {"link_bending@link:2"}, {}, {}}};
  return truth;
}

TEST(Judge, TakesTheEffectItsAliasAndNothingElse) {
  EXPECT_TRUE(judge(yieldingElbow(), {{finding("joint_compliance", "joint:3", "tau3")}, {}, {}, 0, 0}).fates[0].right_driver);
  EXPECT_TRUE(judge(yieldingElbow(), {{finding("link_bending", "link:2", "gravity")}, {}, {}, 0, 0}).fates[0].right);
  const Verdict wrong = judge(yieldingElbow(), {{finding("joint_gain", "joint:3", "q3")}, {}, {}, 0, 0});
  EXPECT_FALSE(wrong.fates[0].right);
  EXPECT_TRUE(wrong.fates[0].right_place);
  EXPECT_EQ(wrong.wrong_names, 1U);
  EXPECT_EQ(wrong.extras, 0U);
}

TEST(Judge, KnowsTheTrueOneAmongTheAlternatives) {
  Finding named = finding("base_compliance", "base", "gravity");
  named.alternatives.push_back({"joint_compliance", "joint:3", 0.1});
  const Verdict verdict = judge(yieldingElbow(), {{named}, {}, {}, 0, 0});
  EXPECT_FALSE(verdict.fates[0].right);
  EXPECT_TRUE(verdict.fates[0].among);
}

TEST(Judge, CountsWhatIsCloseAsOneWhereItIsNamedBesideTheFinding) {
  Truth truth = yieldingElbow();
  truth.effects[0].close = {"base_compliance@base"};
  Finding named = finding("base_compliance", "base", "gravity");
  EXPECT_FALSE(judge(truth, {{named}, {}, {}, 0, 0}).fates[0].in_class);
  named.alternatives.push_back({"joint_compliance", "joint:3", 0.1});
  const Verdict verdict = judge(truth, {{named}, {}, {}, 0, 0});
  EXPECT_TRUE(verdict.fates[0].in_class);
  EXPECT_FALSE(verdict.fates[0].right);
  EXPECT_EQ(verdict.wrong_names, 0U);
  EXPECT_FALSE(verdict.stated[0].true_);
}

TEST(Judge, TakesUnknownForNoName) {
  const Verdict verdict = judge(yieldingElbow(), {{finding("unknown", "joint:3", "tau3")}, {}, {}, 0, 0});
  EXPECT_FALSE(verdict.fates[0].right);
  EXPECT_TRUE(verdict.fates[0].unknown_driver);
  EXPECT_EQ(verdict.wrong_names, 0U);
}

TEST(Judge, LetsWildRowsBeFoundWhereThereAreSome) {
  Truth truth;
  truth.set = "untidy";
  const Answer answer{{finding("bad_samples", "samples", "none")}, {}, {}, 0, 0};
  EXPECT_EQ(judge(truth, answer).findings, 1U);
  truth.wild = {"images/0003.png"};
  EXPECT_EQ(judge(truth, answer).findings, 0U);
}

/// A case of a recording: what was brought into it, and what was said.
Scored ofRecording(const std::vector<TrueEffect>& effects, const std::vector<Finding>& findings) {
  Scored scored;
  scored.truth.set = "injected";
  scored.truth.recording = "some-arm";
  scored.truth.effects = effects;
  scored.answer.findings = findings;
  scored.answered = true;
  scored.verdict = judge(scored.truth, scored.answer);
  return scored;
}

TEST(Injected, AgreesWithinWhatIsStated) {
  TrueEffect gain;
  gain.parameters = {{"gain", 2e-3}};
  Finding said = finding("joint_gain", "joint:1", "q1");
  said.parameters = {{"gain", 2.19e-3}};
  said.deviations = {{"gain", 1e-4}};
  EXPECT_TRUE(agrees(gain, said));
  said.parameters["gain"] = 2.2e-3;  // 2 sigma; 95 % lie within 1.96
  EXPECT_FALSE(agrees(gain, said));
  said.deviations.clear();
  EXPECT_FALSE(agrees(gain, said));
}

TEST(Injected, IsHeldAgainstTheRecordingAsItIs) {
  TrueEffect gain;
  gain.effect = "joint_gain";
  gain.location = "joint:1";
  const Finding pedestal = finding("base_compliance", "base", "gravity"), named = finding("joint_gain", "joint:1", "q1");
  const std::string table = injected({ofRecording({}, {pedestal}), ofRecording({gain}, {pedestal, named})});
  EXPECT_THAT(table, testing::HasSubstr("some-arm as it is: base_compliance@base."));
  EXPECT_THAT(table, testing::HasSubstr("| all | found, in its place | 100.0 % (1/1"));
  EXPECT_THAT(table, testing::HasSubstr("| all | absent from the recording as it is | 100.0 % (1/1"));
  EXPECT_THAT(table, testing::HasSubstr("| all | nothing else new | 100.0 % (1/1"));
  const std::string always = injected({ofRecording({}, {named}), ofRecording({gain}, {named, pedestal})});
  EXPECT_THAT(always, testing::HasSubstr("| all | absent from the recording as it is | 0.0 % (0/1"));
  EXPECT_THAT(always, testing::HasSubstr("| all | nothing else new | 0.0 % (0/1"));
  Finding doubtful = pedestal;
  doubtful.alternatives.push_back(finding("link_bending", "link:1", "gravity"));
  const std::string other_of_two =
      injected({ofRecording({}, {doubtful}), ofRecording({gain}, {named, finding("link_bending", "link:1", "gravity")})});
  EXPECT_THAT(other_of_two, testing::HasSubstr("| all | nothing else new | 100.0 % (1/1"));
}

TEST(Wilson, HasTheKnownEnds) {
  // Agresti and Coull 1998: no success in n trials ends at z^2 / (n + z^2).
  EXPECT_NEAR(wilson(0, 400).high, 3.8415 / 403.8415, 1e-5);
  EXPECT_EQ(wilson(0, 400).low, 0.0);
  EXPECT_NEAR(wilson(50, 100).low, 0.4038, 1e-4);
  EXPECT_NEAR(wilson(50, 100).high, 0.5962, 1e-4);
}

}  // namespace
}  // namespace withheld
