#include "diagnosis/condensed_rows.hpp"

#include <Eigen/LU>
#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

/// [X r]' C^-1 [X r] with C written out.
Eigen::MatrixXd denseSums(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::MatrixXd& extra,
                          const Eigen::VectorXd& theta) {
  Eigen::MatrixXd all(rows.size(), rows.J.cols() + extra.cols() + 1);
  all << rows.J, extra, rows.r;
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(all.cols(), all.cols());
  int from = 0;
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    const int size = rows.groupSize(g);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t i = 0; i < components.size(); ++i) {
      const double variance = theta(static_cast<Eigen::Index>(i));
      if (components[i].white) {
        C.diagonal().array() += variance;
      } else {
        C += variance * components[i].Z[g] * components[i].Z[g].transpose();
      }
    }
    const Eigen::MatrixXd of_pose = all.middleRows(from, size);
    sums += of_pose.transpose() * C.inverse() * of_pose;
    from += size;
  }
  return sums;
}

TEST(CondensedRows, HoldAllThatTheRowsSay) {
  const MeasuredCell measured = test::smallCell(41, 20, 0.1, {}).measured();
  const ModelState state = test::nominalState(measured);
  const CaptureRows rows = captureRows(measured, state, {});
  // Corners by themselves, and one joint that moves at random: of a pose's eight rows one is what these share.
  std::vector<NoiseComponent> components;
  for (NoiseComponent& each : noiseComponents(measured, rows)) {
    if (each.white) components.push_back(std::move(each));
  }
  components.push_back(jointScatter(rows, 2, 1e-8));
  Rng rng = test::rngOfThisTest();
  Eigen::MatrixXd extra(rows.size(), 2);
  for (double& each : extra.reshaped()) each = rng.normal();
  Eigen::VectorXd theta(static_cast<Eigen::Index>(components.size()));
  for (std::size_t i = 0; i < components.size(); ++i) theta(static_cast<Eigen::Index>(i)) = components[i].start * rng.uniform(0.5, 2.0);
  const CondensedRows condensed(rows, components, extra);
  ASSERT_TRUE(condensed.white);
  EXPECT_LT(condensed.Xr.rows(), rows.size()) << "nothing was condensed";
  EXPECT_EQ(static_cast<int>(condensed.beyond) + condensed.Xr.rows(), rows.size());

  Eigen::MatrixXd sums = condensed.squares / theta(static_cast<Eigen::Index>(*condensed.white));
  std::size_t next = 0;
  forWhitenedPoses(condensed, theta, [&](const WhitenedPoses& some) {
    EXPECT_EQ(some.begin, next) << "poses come in their order";
    next = some.end;
    sums += some.Xr.transpose() * some.Xr;
  });
  EXPECT_EQ(next, rows.groups.size());
  const Eigen::MatrixXd dense = denseSums(rows, components, extra, theta);
  // Columns have sizes of their own.
  const Eigen::VectorXd size = dense.diagonal().cwiseSqrt();
  EXPECT_LT(((sums - dense).array() / (size * size.transpose()).array()).abs().maxCoeff(), 1e-10);
}

}  // namespace
}  // namespace poecal
