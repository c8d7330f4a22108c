// Smooth fields over several joints: where they are found, over which joints, and that noise has none.
#include "diagnosis/smooth_field.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "diagnosis/screening.hpp"
#include "diagnosis/small_cell.hpp"

namespace poecal {
namespace {

using test::Fitted;
using test::fitted;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kSigma = 0.1;  // [px]

/// A hill and a dale over q1 and q4 that turn the third joint.
test::SmallCell hilly(std::uint64_t seed, int poses) {
  test::SmallCell small = test::smallCell(seed, poses, kSigma, {});
  const auto hill = [](const Eigen::VectorXd& q, double a, double b) {
    return std::exp(-0.5 * (Eigen::Vector2d(q(0) - a, q(3) - b) / 0.6).squaredNorm());
  };
  test::observeWith(
      small, 2, [&](const Eigen::VectorXd& q) { return 2e-3 * (hill(q, 0.4, 0.5) - hill(q, -0.3, -0.5)); }, kSigma);
  return small;
}

std::vector<Candidate> fieldsOf(const Fitted& made) { return fieldCandidates(WaveFolds(made.measured, made.linear), made.linear); }

const Candidate* fieldAt(const std::vector<Candidate>& fields, std::size_t joint) {
  const auto there = std::find_if(fields.begin(), fields.end(), [&](const Candidate& field) {
    return field.place == Place{PlaceKind::kJoint, joint};
  });
  return there == fields.end() ? nullptr : &*there;
}

TEST(SmoothField, IsOverTheJointsThatDriveIt) {
  const Fitted made = fitted(hilly(11, 90));
  const std::vector<Candidate> fields = fieldsOf(made);
  const Candidate* field = fieldAt(fields, 2);
  ASSERT_NE(field, nullptr);
  EXPECT_EQ(field->driver.name(), "q1,q4");
  // And no other joint explains as much.
  const std::vector<Evidence> evidence = screen(made.linear, fields);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (&fields[i] == field) continue;
    EXPECT_LT(evidence[i].log_bayes, evidence[static_cast<std::size_t>(field - fields.data())].log_bayes) << fields[i].answer();
  }
}

// k(d) = exp(-|d|^2 / 2 l^2) is the mean of cos(n.d) over its spectrum, of which the candidate takes some: off by no more than so few
// evenly laid points are.
TEST(SmoothField, ItsWavesMakeTheKernel) {
  const std::vector<Candidate> fields = fieldsOf(fitted(hilly(12, 90)));
  const Candidate* field = fieldAt(fields, 2);
  ASSERT_NE(field, nullptr);
  const std::vector<AngleWave>& waves = field->curve->terms;
  double squares = 0.0;
  std::size_t joints = 0;
  for (const AngleWave& wave : waves) {
    for (const auto& [joint, factor] : wave) squares += factor * factor;
    joints = std::max(joints, wave.size());
  }
  const double length = 1.0 / std::sqrt(squares / static_cast<double>(waves.size() * joints));
  Rng rng = test::rngOfThisTest();
  double off = 0.0;
  constexpr int kPairs = 200;
  for (int pair = 0; pair < kPairs; ++pair) {
    Eigen::VectorXd apart = Eigen::VectorXd::Zero(6);
    for (const auto& [joint, factor] : waves.front()) apart(static_cast<Eigen::Index>(joint)) = rng.uniform(-1.5 * length, 1.5 * length);
    double mean = 0.0;
    for (const AngleWave& wave : waves) mean += std::cos(phaseOf(wave, apart)) / static_cast<double>(waves.size());
    off += std::pow(mean - std::exp(-0.5 * apart.squaredNorm() / (length * length)), 2) / kPairs;
  }
  EXPECT_LT(std::sqrt(off), 1.0 / static_cast<double>(waves.size()) + 0.05);
}

TEST(SmoothField, IsNoneInNoise) {
  for (const std::uint64_t seed : {5, 6, 7, 8}) EXPECT_THAT(fieldsOf(fitted(test::smallCell(seed, 80, kSigma, {}))), IsEmpty()) << seed;
}

TEST(SmoothField, DoesNotDependOnTheNumberOfThreads) {
  Fitted made = fitted(hilly(13, 60));
  const std::vector<Candidate> alone = fieldsOf(made);
  made.linear.jobs = 4;
  const std::vector<Candidate> together = fieldsOf(made);
  ASSERT_THAT(alone, Not(IsEmpty()));
  ASSERT_EQ(alone.size(), together.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i].answer(), together[i].answer());
    EXPECT_EQ(alone[i].curve->terms, together[i].curve->terms);
  }
}

// Readings that no function of the posture explains, in any of its joints.
TEST(SmoothField, IsNotWhatMovesAtRandom) {
  test::SmallCell small = test::smallCell(14, 80, kSigma, {});
  Rng rng = test::rngOfThisTest();
  test::observeWith(
      small, 2, [&](const Eigen::VectorXd&) { return 4e-4 * rng.normal(); }, kSigma);
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_EQ(diagnosis.findings.size(), 1u) << diagnosisText(diagnosis, {});
  EXPECT_EQ(diagnosis.findings.front().effect, "joint_scatter");
  EXPECT_EQ(diagnosis.findings.front().location, "joint:3");
}

}  // namespace
}  // namespace poecal
