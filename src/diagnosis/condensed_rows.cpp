#include "diagnosis/condensed_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

// Rows that are whitened at a time: they stay in a core's cache.
constexpr int kRowsAtATime = 512;

}  // namespace

CondensedRows::CondensedRows(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::MatrixXd& extra) {
  for (std::size_t i = 0; i < components.size(); ++i) {
    if (components[i].white) white = i;
  }
  const Eigen::Index base = rows.J.cols(), all = base + extra.cols() + 1;
  Xr.resize(rows.size(), all);
  squares = Eigen::MatrixXd::Zero(all, all);
  poses.reserve(rows.groups.size());
  int from = 0, to = 0;
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    const int size = rows.groupSize(g);
    Pose& pose = poses.emplace_back();
    pose.begin = to;
    for (std::size_t i = 0; i < components.size(); ++i) pose.width.push_back(i == white ? 0 : components[i].Z[g].cols());
    pose.Z.resize(size, std::accumulate(pose.width.begin(), pose.width.end(), Eigen::Index{0}));
    Eigen::Index column = 0;
    for (std::size_t i = 0; i < components.size(); ++i) {
      if (pose.width[i] > 0) pose.Z.middleCols(column, pose.width[i]) = components[i].Z[g];
      column += pose.width[i];
    }
    auto of_pose = Xr.middleRows(to, size);
    of_pose << rows.J.middleRows(from, size), extra.middleRows(from, size), rows.r.segment(from, size);
    pose.size = white ? std::min(size, static_cast<int>(column)) : size;
    if (pose.size < size) {
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(pose.Z);
      of_pose.applyOnTheLeft(qr.householderQ().adjoint());
      pose.Z = qr.matrixQR().topRows(pose.size).triangularView<Eigen::Upper>();
      squares.selfadjointView<Eigen::Lower>().rankUpdate(of_pose.bottomRows(size - pose.size).transpose());
      beyond += size - pose.size;
    }
    from += size;
    to += pose.size;
  }
  Xr.conservativeResize(to, Eigen::NoChange);
  squares.triangularView<Eigen::StrictlyUpper>() = squares.transpose();
}

void forWhitenedPoses(const CondensedRows& rows, const Eigen::VectorXd& theta, const std::function<void(const WhitenedPoses&)>& visit) {
  WhitenedPoses some;
  Eigen::MatrixXd Z, C;
  Eigen::LLT<Eigen::MatrixXd> llt;
  for (std::size_t g = 0; g < rows.poses.size(); ++g) {
    const CondensedRows::Pose& pose = rows.poses[g];
    Z = pose.Z;
    Eigen::Index begin = 0;
    for (std::size_t i = 0; i < pose.width.size(); ++i) {
      Z.middleCols(begin, pose.width[i]) *= std::sqrt(theta(static_cast<Eigen::Index>(i)));
      begin += pose.width[i];
    }
    C.setZero(pose.size, pose.size);
    C.selfadjointView<Eigen::Lower>().rankUpdate(Z);
    if (rows.white) C.diagonal().array() += theta(static_cast<Eigen::Index>(*rows.white));
    llt.compute(C);
    if (llt.info() != Eigen::Success)
      throw InsufficientData("the noise of a pose cannot be told from nothing: its rows repeat each other exactly");
    some.L.push_back(llt.matrixLLT());
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
