#include "diagnosis/condensed_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace poecal {
namespace {

// Rows that are whitened at a time: they stay in a core's cache.
constexpr int kRowsAtATime = 512;

/// A B into C; the few rows of most poses are not worth the preparations of a large product.
void multiply(const Eigen::MatrixXd& A, const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> C) {
  constexpr Eigen::Index kSmall = 16;
  if (A.rows() <= kSmall) {
    C.noalias() = A.lazyProduct(B);
  } else {
    C.noalias() = A * B;
  }
}

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
    if (Z.cols() > 0) C.selfadjointView<Eigen::Lower>().rankUpdate(Z);
    if (rows.white) C.diagonal().array() += theta(static_cast<Eigen::Index>(*rows.white));
    factorNoise(C, llt);
    Eigen::MatrixXd& whitener = some.whitener.emplace_back(Eigen::MatrixXd::Identity(pose.size, pose.size));
    llt.matrixL().solveInPlace(whitener);
    some.end = g + 1;
    const int size = pose.begin + pose.size - some.row;
    if (size < kRowsAtATime && some.end < rows.poses.size()) continue;
    some.Xr.resize(size, rows.Xr.cols());
    for (std::size_t k = some.begin; k < some.end; ++k) {
      const CondensedRows::Pose& each = rows.poses[k];
      multiply(some.whitener[k - some.begin], rows.Xr.middleRows(each.begin, each.size),
               some.Xr.middleRows(each.begin - some.row, each.size));
    }
    if (size > 0) visit(some);
    some.begin = some.end;
    some.row += size;
    some.whitener.clear();
  }
}

}  // namespace poecal
