// The search by itself, and the model that it leaves.
#include "diagnosis/selection.hpp"

#include <gmock/gmock.h>

#include "diagnosis/found_model.hpp"
#include "diagnosis/small_cell.hpp"

namespace poecal {
namespace {

using ::testing::Each;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kPoses = 60;
constexpr double kSigma = 0.1;  // [px]

std::vector<std::string> namesOf(const Selection& selection) {
  std::vector<std::string> names;
  for (const FoundEffect& found : selection.findings) names.push_back(found.name + "@" + found.place.name());
  return names;
}

const std::vector<EffectSpec> kTwo{{"joint_gain", "joint:3", {{"gain", 4e-3}}}, {"joint_backlash", "joint:1", {{"half_gap", 3e-4}}}};

TEST(Selection, StopsAtAsManyFindingsAsItMayHave) {
  const MeasuredCell measured = test::smallCell(51, kPoses, kSigma, kTwo).measured();
  const ModelState state = test::nominalState(measured);
  const std::vector<std::string> both = namesOf(selectEffects(measured, state, {}, {}));
  EXPECT_THAT(both, ::testing::UnorderedElementsAre("joint_gain@joint:3", "joint_backlash@joint:1"));
  EXPECT_THAT(namesOf(selectEffects(measured, state, {}, {.most = 1})), SizeIs(1));
  EXPECT_THAT(namesOf(selectEffects(measured, state, {}, {.most = 0})), IsEmpty());
}

TEST(Selection, WithoutCurvesEveryFindingHasAName) {
  test::SmallCell small = test::smallCell(52, kPoses, kSigma, {});
  // Of no effect's shape.
  test::observeWith(
      small, 2, [](const Eigen::VectorXd& q) { return 1.5e-3 * q(2) * std::exp(-2.0 * q(2)); }, kSigma);
  const MeasuredCell measured = small.measured();
  const ModelState state = test::nominalState(measured);
  const Selection free = selectEffects(measured, state, {}, {});
  ASSERT_FALSE(free.findings.empty());
  EXPECT_TRUE(free.findings.front().isUnknown()) << free.findings.front().name;
  for (const FoundEffect& found : selectEffects(measured, state, {}, {.curves = false}).findings) EXPECT_FALSE(found.isUnknown());
}

// Three explanations in place of one curve of the lens, which follows all of them: each is a cause of its own, to be mended by itself.
TEST(Selection, ALensThatIsWrongInSeveralWaysHasANameForEach) {
  const MeasuredCell measured = test::smallCell(54, kPoses, kSigma,
                                                {{"lens_distortion", "camera.lens", {{"dk1", -0.08}, {"dk2", 0.05}}},
                                                 {"focal_length", "camera.lens", {{"scale", 0.01}}}})
                                    .measured();
  const std::vector<std::string> names = namesOf(selectEffects(measured, test::nominalState(measured), {}, {}));
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("lens_distortion@camera.lens", "focal_length@camera.lens"));
}

/// What is found where joint 3 really stands where `error` moves it.
Selection searchedWith(std::uint64_t seed, const test::JointError& error) {
  test::SmallCell small = test::smallCell(seed, kPoses, kSigma, {});
  test::observeWith(small, 2, error, kSigma);
  const MeasuredCell measured = small.measured();
  return selectEffects(measured, test::nominalState(measured), {}, {});
}

// A wave of two other joints is beside it at the same joint; waves alone would follow both.
TEST(Selection, ANameIsFoundInsideTheStructureOfItsJoint) {
  const Selection selection =
      searchedWith(55, [](const Eigen::VectorXd& q) { return 4e-3 * q(2) + 6e-4 * std::sin(2.0 * q(0) + 3.0 * q(3)); });
  EXPECT_THAT(namesOf(selection), ::testing::UnorderedElementsAre("joint_gain@joint:3", "unknown@joint:3"));
}

// The wave hangs on the reading that leaks too, with another joint's: it is no shape of the leak, which is proportional to it.
TEST(Selection, ANameIsFoundBesideAWaveOfItsOwnDriver) {
  const Selection selection =
      searchedWith(56, [](const Eigen::VectorXd& q) { return 4e-3 * q(4) + 6e-4 * std::sin(2.0 * q(0) + 3.0 * q(4)); });
  EXPECT_THAT(namesOf(selection), ::testing::UnorderedElementsAre("joint_coupling@joint:3", "unknown@joint:3"));
  for (const FoundEffect& found : selection.findings) {
    const auto& answers = found.ranking.answers;
    for (const RankedAnswer& other : answers) EXPECT_LE(other.log_weight, answers.front().log_weight) << found.name << ": " << other.name;
  }
}

// Rests on either side of small gaps look like joints that come back badly. With one backlash in, less of that unrest is left, and the
// other shows; by itself neither has the evidence that a second finding needs.
TEST(Selection, TwoEffectsThatHideEachOtherAreTakenUpTogether) {
  constexpr double kGap = 3.8e-5;  // [rad] at the edge of what this cell shows of one
  const MeasuredCell measured = test::smallCell(77, kPoses, kSigma,
                                                {{"joint_gain", "joint:3", {{"gain", 4e-3}}},
                                                 {"joint_backlash", "joint:1", {{"half_gap", kGap}}},
                                                 {"joint_backlash", "joint:2", {{"half_gap", kGap}}}})
                                    .measured();
  const ModelState state = test::nominalState(measured);
  EXPECT_THAT(namesOf(selectEffects(measured, state, {}, {})),
              ::testing::UnorderedElementsAre("joint_gain@joint:3", "joint_backlash@joint:1", "joint_backlash@joint:2"));
  // Both or neither: there is room for one more alone.
  EXPECT_THAT(namesOf(selectEffects(measured, state, {}, {.most = 2})), ::testing::ElementsAre("joint_gain@joint:3"));
}

TEST(Selection, ANameThatIsRefusedIsNotGiven) {
  const MeasuredCell measured = test::smallCell(51, kPoses, kSigma, kTwo).measured();
  const ModelState state = test::nominalState(measured);
  const Selection free = selectEffects(measured, state, {}, {});
  ASSERT_FALSE(free.findings.empty());
  const Selection other = selectEffects(measured, state, {}, {.refused = {free.findings.front().accepted->candidate.answer()}});
  EXPECT_THAT(namesOf(other), ::testing::Not(::testing::Contains(namesOf(free).front())));
  for (const Candidate& candidate : other.candidates) EXPECT_NE(candidate.answer(), free.findings.front().accepted->candidate.answer());
}

TEST(Selection, WildRowsAreTakenOutAndListed) {
  test::SmallCell small = test::smallCell(53, kPoses, kSigma, {});
  for (CornerMeasurement& corner : small.observations[7].corners) corner.px += Eigen::Vector2d(9.0, -4.0);
  const MeasuredCell measured = small.measured();
  const Selection selection = selectEffects(measured, test::nominalState(measured), {}, {});
  EXPECT_THAT(selection.bad, ::testing::ElementsAre(7u));
  EXPECT_THAT(selection.findings, IsEmpty());
  EXPECT_EQ(selection.measured.observations.size(), static_cast<std::size_t>(kPoses - 1));
}

}  // namespace
}  // namespace poecal
