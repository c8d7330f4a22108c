// What stands beside an effect as one candidate: shares of its size, and the times of slips.
#include "diagnosis/candidates.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "diagnosis/evidence.hpp"
#include "diagnosis/small_cell.hpp"

namespace poecal {
namespace {

using ::testing::IsEmpty;

struct Listed {
  MeasuredCell measured;
  std::vector<Candidate> candidates;
};

Listed listed(int poses) {
  const test::SmallCell small = test::smallCell(8, poses, 0.1, {});
  Listed made;
  made.measured.start = small.cell;
  made.measured.free = {.twists = true, .near = true, .far = true};
  made.measured.samples = small.samples;
  made.measured.target = small.target;
  made.candidates = allCandidates(made.measured, {CellState(small.cell, made.measured.free), {}}).candidates;
  return made;
}

std::vector<Candidate> ofAnswer(const Listed& made, const std::string& answer) {
  std::vector<Candidate> some;
  std::copy_if(made.candidates.begin(), made.candidates.end(), std::back_inserter(some),
               [&](const Candidate& candidate) { return candidate.answer() == answer; });
  return some;
}

TEST(MassErrors, AreAShareOfTheComplianceThatWasFound) {
  const Candidate bending = ofAnswer(listed(40), "link_bending@link:2/gravity").at(0);
  ASSERT_EQ(bending.own(), 2);
  const Eigen::Index of_each = (bending.typical.size() - 2) / 2;
  const Eigen::Vector2d found(0.5 * bending.typical(0), 100.0 * bending.typical(1));
  const Eigen::VectorXd sigma = bending.spread(3.0, found);
  EXPECT_EQ(sigma.head<2>(), 3.0 * bending.typical.head<2>());
  EXPECT_EQ(Eigen::VectorXd(sigma.segment(2, of_each)), 0.5 * bending.typical.segment(2, of_each));
  // No more than the scale allows of the effect itself.
  EXPECT_EQ(Eigen::VectorXd(sigma.tail(of_each)), 3.0 * bending.typical.tail(of_each));
}

// Rows that know everything and ask for mass errors alone: ten standard deviations of one of them.
TEST(MassErrors, ExplainNothingWithoutACompliance) {
  const Candidate bending = ofAnswer(listed(40), "link_bending@link:2/gravity").at(0);
  const Eigen::Index count = bending.typical.size();
  // A typical size in standard deviations: the compliance is known to be a thousandth of it, or less.
  constexpr double kOwn = 1000.0, kOfMasses = 30.0;
  Eigen::VectorXd root = kOfMasses * bending.typical.cwiseInverse();
  root.head<2>() = kOwn * bending.typical.head<2>().cwiseInverse();
  const Eigen::MatrixXd S = root.cwiseAbs2().asDiagonal();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(count);
  u(2) = 10.0 * root(2);
  EXPECT_LT(evidenceOf(S, u, bending).log_bayes, 0.0);
  // With a compliance of its typical size they are believed: the same ten deviations are worth more than the compliance alone.
  u(0) = kOwn * root(0);
  const double both = evidenceOf(S, u, bending).log_bayes;
  u(2) = 0.0;
  EXPECT_GT(both, evidenceOf(S, u, bending).log_bayes + 40.0);  // 10^2 / 2, less what the prior takes
}

// A scan, row by row: joint 1 steps on after each row, joint 2 goes to and fro in it. Whatever changes with time then changes with joint 1.
TEST(Curves, OfTimeAreNoneWhereTheRowsFollowAJoint) {
  Listed made = listed(60);
  const auto driven = [&made](const std::string& driver, PlaceKind place) {
    const CandidateList list = allCandidates(made.measured, {CellState(made.measured.start, made.measured.free), {}});
    return std::count_if(list.candidates.begin(), list.candidates.end(),
                         [&](const Candidate& candidate) { return candidate.driver.name() == driver && candidate.place.kind == place; });
  };
  made.measured.timed = false;
  for (std::size_t k = 0; k < made.measured.samples.size(); ++k) made.measured.samples[k].stamp = static_cast<double>(k);
  EXPECT_GT(driven("stamp", PlaceKind::kCameraMount), 0);
  EXPECT_EQ(driven("q1", PlaceKind::kCameraMount), 0);
  for (std::size_t k = 0; k < made.measured.samples.size(); ++k) {
    made.measured.samples[k].q(0) = 0.1 * static_cast<double>(k / 6);
    made.measured.samples[k].q(1) = 0.3 * static_cast<double>(k % 6);
  }
  EXPECT_EQ(driven("stamp", PlaceKind::kCameraMount), 0);
  EXPECT_EQ(driven("stamp", PlaceKind::kJoint), 0);
  EXPECT_EQ(driven("q1", PlaceKind::kCameraMount), 1);
  // Times that were recorded tell a slip, which is no smooth change; the order of the rows is no time.
  made.measured.timed = true;
  EXPECT_GT(driven("stamp", PlaceKind::kCameraMount), 0);
}

TEST(SlipTimes, AreAllTriedAroundTheBest) {
  const Listed made = listed(200);
  const std::vector<Candidate> tried = ofAnswer(made, "joint_slip@joint:3/stamp");
  ASSERT_EQ(tried.size(), 100u);
  std::vector<double> stamps;
  for (const Sample& sample : made.measured.samples) stamps.push_back(*sample.stamp);
  std::sort(stamps.begin(), stamps.end());
  const auto before = [&](double time) { return std::lower_bound(stamps.begin(), stamps.end(), time) - stamps.begin(); };
  constexpr std::size_t kBest = 30;
  std::vector<std::ptrdiff_t> poses{before(tried[kBest].parameters(0))};
  for (const Candidate& untried : untriedTimes(tried[kBest], made.measured.samples)) poses.push_back(before(untried.parameters(0)));
  std::sort(poses.begin(), poses.end());
  // Every pose between the neighbours that were tried, once.
  std::vector<std::ptrdiff_t> expected;
  for (std::ptrdiff_t k = before(tried[kBest - 1].parameters(0)) + 1; k < before(tried[kBest + 1].parameters(0)); ++k) {
    expected.push_back(k);
  }
  EXPECT_EQ(poses, expected);
}

// Three shots of each pose, a second apart, and twenty until the next pose: a slip is twenty times as likely in a pause as between shots.
TEST(SlipTimes, AreMostlyInThePausesBetweenPoses) {
  Listed made = listed(240);
  constexpr double kShots = 3.0, kPause = 20.0;
  for (std::size_t k = 0; k < made.measured.samples.size(); ++k) {
    const double shot = std::fmod(static_cast<double>(k), kShots), pose = (static_cast<double>(k) - shot) / kShots;
    made.measured.samples[k].stamp = pose * (kShots - 1.0 + kPause) + shot;
  }
  made.candidates = allCandidates(made.measured, {CellState(made.measured.start, made.measured.free), {}}).candidates;
  const std::vector<Candidate> tried = ofAnswer(made, "joint_slip@joint:3/stamp");
  const auto inPause = [&](const Candidate& slip) { return std::fmod(slip.parameters(0), kShots - 1.0 + kPause) > kShots - 1.0; };
  const auto pauses = std::count_if(tried.begin(), tried.end(), inPause);
  EXPECT_EQ(pauses, 79);  // all of them
  EXPECT_GT(pauses, 4 * (static_cast<std::ptrdiff_t>(tried.size()) - pauses));
}

// A mount's slip has six numbers, a joint's has one.
TEST(SlipTimes, LeaveAsManyRowsAsTheSlipHasNumbers) {
  const Listed made = listed(50);
  EXPECT_THAT(ofAnswer(made, "joint_slip@joint:3/stamp"), ::testing::SizeIs(50 - 1 - 2 * 2));
  EXPECT_THAT(ofAnswer(made, "target_slip@target.mount/stamp"), ::testing::SizeIs(50 - 1 - 2 * 5));
}

// The columns by (m, m d) and the parameters (m, m c) are two ways to one motion of the target.
TEST(MassBelief, IsAboutTheSameMotions) {
  test::SmallCell small = test::smallCell(8, 40, 0.1, {});
  small.nominal.links.clear();
  const test::Fitted fit = test::fitted(small);
  for (const Candidate& candidate : allCandidates(fit.measured, fit.linear.state).candidates) {
    if (candidate.to_parameters.size() == 0) continue;
    const Eigen::VectorXd factors = candidate.typical;
    Eigen::VectorXd parameters = candidate.parameters;
    const Eigen::VectorXd linear = candidate.linearParameters(factors);
    for (std::size_t i = 0; i < candidate.linear.size(); ++i) parameters(candidate.linear[i]) = linear(static_cast<Eigen::Index>(i));
    const Eigen::VectorXd rows = columnsOf(candidate, fit.linear.rows) * factors;
    for (const ObservationRows& part : fit.linear.rows.observations) {
      const Eigen::VectorXd moved = part.along(disturbanceOf({{*candidate.effect, parameters}}, part.context));
      EXPECT_LT((rows.segment(part.begin, part.size) - moved).norm(), 1e-9 * (1.0 + moved.norm())) << candidate.answer();
    }
  }
}

TEST(SlipTimes, AreNoneBesideWhereAllAreTried) {
  const Listed made = listed(50);
  EXPECT_THAT(untriedTimes(ofAnswer(made, "joint_slip@joint:3/stamp").at(10), made.measured.samples), IsEmpty());
  EXPECT_THAT(untriedTimes(ofAnswer(made, "joint_gain@joint:3/q3").at(0), made.measured.samples), IsEmpty());
}

}  // namespace
}  // namespace poecal
