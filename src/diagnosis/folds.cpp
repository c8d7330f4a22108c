#include "diagnosis/folds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "poecal/core/random.hpp"

namespace poecal {
namespace {

Folds randomFolds(std::size_t groups, std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(groups);
  std::iota(order.begin(), order.end(), 0);
  Rng rng(seed);
  for (std::size_t k = groups; k > 1; --k) std::swap(order[k - 1], order[rng.below(k)]);
  Folds folds(count);
  for (std::size_t k = 0; k < groups; ++k) folds[k % count].push_back(order[k]);
  return folds;
}

Folds timeBlocks(const MeasuredCell& measured, std::size_t count) {
  const std::size_t groups = measured.groups.size();
  const auto first = [&measured](std::size_t g) -> const Sample& { return measured.samples[measured.groups[g].front()]; };
  bool stamped = true;
  for (std::size_t g = 0; g < groups; ++g) stamped = stamped && first(g).stamp.has_value();
  std::vector<std::size_t> order(groups);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return stamped ? *first(a).stamp < *first(b).stamp : measured.groups[a].front() < measured.groups[b].front();
  });
  Folds folds(count);
  for (std::size_t k = 0; k < groups; ++k) folds[k * count / groups].push_back(order[k]);
  return folds;
}

/// Joint readings of each group, one row each, in units of their spread.
Eigen::MatrixXd postures(const MeasuredCell& measured) {
  const Eigen::Index joints = measured.samples.front().q.size();
  Eigen::MatrixXd q(static_cast<Eigen::Index>(measured.groups.size()), joints);
  for (Eigen::Index g = 0; g < q.rows(); ++g) {
    q.row(g) = measured.samples[measured.groups[static_cast<std::size_t>(g)].front()].q.transpose();
  }
  q.rowwise() -= q.colwise().mean().eval();
  for (Eigen::Index k = 0; k < joints; ++k) {
    const double spread = q.col(k).norm();
    if (spread > 0.0) q.col(k) /= spread;
  }
  return q;
}

/// Squared distance of each row from the nearest centre, and which that is.
std::vector<std::pair<double, std::size_t>> nearest(const Eigen::MatrixXd& q, const std::vector<Eigen::RowVectorXd>& centres) {
  std::vector<std::pair<double, std::size_t>> all;
  for (Eigen::Index g = 0; g < q.rows(); ++g) {
    std::pair<double, std::size_t> best{std::numeric_limits<double>::infinity(), 0};
    for (std::size_t c = 0; c < centres.size(); ++c) best = std::min(best, {(q.row(g) - centres[c]).squaredNorm(), c});
    all.push_back(best);
  }
  return all;
}

/// Lloyd's algorithm from centres that are as far from each other as can be.
Folds postureClusters(const MeasuredCell& measured, std::size_t count) {
  const Eigen::MatrixXd q = postures(measured);
  std::vector<Eigen::RowVectorXd> centres{Eigen::RowVectorXd::Zero(q.cols())};
  for (bool middle = true; centres.size() < count || middle; middle = false) {
    const auto far = nearest(q, centres);
    const Eigen::RowVectorXd farthest = q.row(std::max_element(far.begin(), far.end()) - far.begin());
    if (middle) centres.clear();
    centres.push_back(farthest);
  }
  constexpr int kRounds = 20;
  Folds folds;
  for (int round = 0; round < kRounds; ++round) {
    Folds next(count);
    const auto near = nearest(q, centres);
    for (std::size_t g = 0; g < near.size(); ++g) next[near[g].second].push_back(g);
    for (std::size_t c = 0; c < count; ++c) {
      if (next[c].empty()) continue;
      centres[c].setZero();
      for (const std::size_t g : next[c]) centres[c] += q.row(static_cast<Eigen::Index>(g)) / static_cast<double>(next[c].size());
    }
    if (next == folds) break;
    folds = std::move(next);
  }
  std::erase_if(folds, [](const std::vector<std::size_t>& fold) { return fold.empty(); });
  return folds;
}

}  // namespace

Folds makeFolds(const MeasuredCell& measured, HeldOut kind, int folds, std::uint64_t seed) {
  const std::size_t groups = measured.groups.size();
  const auto count = std::min(groups, static_cast<std::size_t>(std::max(2, folds)));
  Folds made = kind == HeldOut::kTime ? timeBlocks(measured, count) : Folds{};
  if (kind == HeldOut::kPosture) made = postureClusters(measured, count);
  // Poses that are all alike have no clusters.
  if (made.size() < 2) made = randomFolds(groups, count, seed);
  for (std::vector<std::size_t>& fold : made) std::sort(fold.begin(), fold.end());
  return made;
}

}  // namespace poecal
