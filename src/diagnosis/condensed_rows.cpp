#include "diagnosis/condensed_rows.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

// Rows that are whitened at a time: they stay in a core's cache.
constexpr int kRowsAtATime = 512;

int groupRows(const CaptureRows& rows, std::size_t g) {
  int count = 0;
  for (const std::size_t k : rows.groups[g]) count += rows.observations[k].size;
  return count;
}

}  // namespace

CondensedRows::CondensedRows(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::MatrixXd& extra) {
  for (std::size_t i = 0; i < components.size(); ++i) {
    if (components[i].white) white = i;
  }
  const Eigen::Index base = rows.J.cols(), all = base + extra.cols() + 1;
  Xr.resize(rows.size(), all);
  squares = Eigen::MatrixXd::Zero(all, all);
  int from = 0, to = 0;
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    const int size = groupRows(rows, g);
    Eigen::Index sum = 0;
    std::vector<Eigen::Index>& widths = width.emplace_back();
    for (std::size_t i = 0; i < components.size(); ++i) sum += widths.emplace_back(i == white ? 0 : components[i].Z[g].cols());
    Eigen::MatrixXd Z(size, sum);
    Eigen::Index begin = 0;
    for (std::size_t i = 0; i < components.size(); ++i) {
      if (widths[i] > 0) Z.middleCols(begin, widths[i]) = components[i].Z[g];
      begin += widths[i];
    }
    Eigen::MatrixXd of_pose(size, all);
    of_pose << rows.J.middleRows(from, size), extra.middleRows(from, size), rows.r.segment(from, size);
    int kept = size;
    if (white && sum < size) {
      kept = static_cast<int>(sum);
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(Z);
      of_pose.applyOnTheLeft(qr.householderQ().adjoint());
      Z = qr.matrixQR().topRows(kept).triangularView<Eigen::Upper>();
      squares.selfadjointView<Eigen::Lower>().rankUpdate(of_pose.bottomRows(size - kept).transpose());
      beyond += size - kept;
    }
    Xr.middleRows(to, kept) = of_pose.topRows(kept);
    poses.push_back({to, kept, std::move(Z)});
    from += size;
    to += kept;
  }
  Xr.conservativeResize(to, Eigen::NoChange);
  squares.triangularView<Eigen::StrictlyUpper>() = squares.transpose();
}

void forWhitenedPoses(const CondensedRows& rows, const Eigen::VectorXd& theta, const std::function<void(const WhitenedPoses&)>& visit) {
  WhitenedPoses some;
  for (std::size_t g = 0; g < rows.poses.size(); ++g) {
    const CondensedRows::Pose& pose = rows.poses[g];
    Eigen::MatrixXd Z = pose.Z;
    Eigen::Index begin = 0;
    for (std::size_t i = 0; i < rows.width[g].size(); ++i) {
      Z.middleCols(begin, rows.width[g][i]) *= std::sqrt(theta(static_cast<Eigen::Index>(i)));
      begin += rows.width[g][i];
    }
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(pose.size, pose.size);
    C.selfadjointView<Eigen::Lower>().rankUpdate(Z);
    if (rows.white) C.diagonal().array() += theta(static_cast<Eigen::Index>(*rows.white));
    const Eigen::LLT<Eigen::MatrixXd> llt(C);
    if (llt.info() != Eigen::Success)
      throw InsufficientData("the noise of a pose cannot be told from nothing: its rows repeat each other exactly");
    some.L.push_back(llt.matrixL());
    some.end = g + 1;
    const int size = pose.begin + pose.size - some.row;
    if (size < kRowsAtATime && some.end < rows.poses.size()) continue;
    some.Xr = rows.Xr.middleRows(some.row, size);
    for (std::size_t k = some.begin; k < some.end; ++k) {
      auto block = some.Xr.middleRows(rows.poses[k].begin - some.row, rows.poses[k].size);
      some.L[k - some.begin].triangularView<Eigen::Lower>().solveInPlace(block);
    }
    visit(some);
    some.begin = some.end;
    some.row += size;
    some.L.clear();
  }
}

}  // namespace poecal
