// Screening in blocks and as ports see the rows, against the same sums of whole matrices.
#include "diagnosis/screening.hpp"

#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"

namespace poecal {
namespace {

/// A cell with repeats: a pose of three pictures, then one of two, one of one, and so on.
struct Repeated {
  MeasuredCell measured;
  Linearised linear;
  std::vector<Candidate> candidates;
};

Repeated repeated(int pictures) {
  const test::SmallCell small = test::smallCell(7, pictures, 0.1, {});
  Repeated made{small.measured(), {}, {}};
  MeasuredCell& measured = made.measured;
  measured.groups.clear();
  for (std::size_t k = 0, shots = 3; k<measured.observations.size(); shots = shots> 1 ? shots - 1 : 3) {
    std::vector<std::size_t>& group = measured.groups.emplace_back();
    for (std::size_t shot = 0; shot < shots && k < measured.observations.size(); ++shot) group.push_back(k++);
  }
  const ModelState state = test::nominalState(measured);
  made.linear = linearise(measured, state, {}, {}, {});
  setNoise(measured, NoiseEstimate{.theta = Eigen::VectorXd(), .b = {}, .covariance = {}}, made.linear);
  // Some of each kind: there are two thousand.
  const std::vector<Candidate> all = allCandidates(measured, state).candidates;
  for (std::size_t i = 0; i < all.size(); i += 17) made.candidates.push_back(all[i]);
  return made;
}

/// C of the whole capture.
Eigen::MatrixXd noiseCovariance(const Linearised& linear) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(linear.rows.size(), linear.rows.size());
  Eigen::Index begin = 0;
  for (std::size_t g = 0; g < linear.rows.groups.size(); ++g) {
    const Eigen::Index size = linear.rows.groupSize(g);
    for (std::size_t i = 0; i < linear.components.size(); ++i) {
      const Eigen::MatrixXd& Z = linear.components[i].Z[g];
      C.block(begin, begin, size, size) += linear.noise.theta(static_cast<Eigen::Index>(i)) * Z * Z.transpose();
    }
    begin += size;
  }
  return C;
}

TEST(Screening, IsWhatWholeMatricesGive) {
  // Rows of more than one block.
  const Repeated made = repeated(160);
  const Linearised& linear = made.linear;
  ASSERT_GT(made.candidates.size(), 50u);
  const std::vector<Evidence> screened = screen(linear, made.candidates);
  const Eigen::MatrixXd W = noiseCovariance(linear).inverse(), X = linear.allColumns();
  const Eigen::VectorXd r = linear.rows.r - X * linear.noise.b;
  for (std::size_t i = 0; i < made.candidates.size(); ++i) {
    const Candidate& candidate = made.candidates[i];
    const Eigen::MatrixXd x = columnsOf(candidate, linear.rows);
    const Eigen::MatrixXd cross = X.transpose() * W * x;
    const Evidence dense =
        evidenceOf(x.transpose() * W * x - cross.transpose() * linear.noise.covariance * cross, x.transpose() * W * r, candidate);
    // The difference of two nearly equal informations keeps about six digits.
    constexpr double kRelative = 1e-5;
    EXPECT_NEAR(screened[i].log_bayes, dense.log_bayes, kRelative * (1.0 + std::abs(dense.log_bayes))) << candidate.answer();
    EXPECT_NEAR(screened[i].information, dense.information, kRelative * (1.0 + dense.information)) << candidate.answer();
  }
}

TEST(Screening, DoesNotDependOnTheNumberOfThreads) {
  Repeated made = repeated(160);
  const std::vector<Evidence> alone = screen(made.linear, made.candidates);
  made.linear.jobs = 4;
  const std::vector<Evidence> together = screen(made.linear, made.candidates);
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(alone[i].log_bayes, together[i].log_bayes) << made.candidates[i].answer();
}

}  // namespace
}  // namespace poecal
