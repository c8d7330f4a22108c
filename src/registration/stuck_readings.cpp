#include "registration/stuck_readings.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "capture/still_readings.hpp"
#include "poecal/core/statistics.hpp"
#include "registration/problem.hpp"

namespace poecal {
namespace {

class Finder {
 public:
  Finder(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples)
      : cell_(cell), observations_(observations), samples_(samples), order_(observations.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return observations[a].sample < observations[b].sample; });
  }

  std::optional<StuckReadings> find() const {
    const auto joints = observations_.front().q.size();
    const RowRun frozen =
        longestRun(order_.size(), [&](std::size_t k) { return samePose(poseAt(k), poseAt(k - 1)) && row(k).q == row(k - 1).q; });
    std::optional<StuckReadings> found = judged("the readings stay", frozen);
    for (Eigen::Index joint = 0; joint < joints && !found; ++joint) {
      const RowRun run = longestRun(order_.size(), [&](std::size_t k) { return row(k).q(joint) == row(k - 1).q(joint); });
      if (comeBack(order_.size(), run, [&](std::size_t k) { return row(k).q(joint); })) continue;
      found = judged(fmt::format("q{} stays at exactly {:.6g}", joint + 1, row(run.begin).q(joint)), run);
    }
    return found;
  }

 private:
  const Observation& row(std::size_t k) const { return observations_[order_[k]]; }
  const Eigen::Isometry3d& poseAt(std::size_t k) const { return samples_[order_[k]].T_near_far; }

  /// Whether the target is seen to move in a run; shots of one pose show it where it was.
  bool targetMoves(const RowRun& run) const {
    constexpr double kMovedPx = 5.0, kMoved = 5e-3;  // far beyond what poses come back by, in pictures and in metres
    std::size_t moved = 0;
    for (std::size_t k = run.begin + 1; k < run.end; ++k) {
      const Observation &here = row(k), &before = row(k - 1);
      if (here.pose && before.pose) {
        moved += (here.pose->T_camera_target.translation() - before.pose->T_camera_target.translation()).norm() > kMoved;
        continue;
      }
      std::map<PointId, Eigen::Vector2d> seen;
      for (const CornerMeasurement& corner : before.corners) seen[corner.id] = corner.px;
      double farthest = 0.0;
      for (const CornerMeasurement& corner : here.corners) {
        const auto same = seen.find(corner.id);
        if (same != seen.end()) farthest = std::max(farthest, (corner.px - same->second).norm());
      }
      moved += farthest > kMovedPx;
    }
    return 2 * moved + 1 > run.size();
  }

  std::optional<StuckReadings> judged(const std::string& what, const RowRun& run) const {
    if (run.size() < kFewestStill || order_.size() - run.size() < kFewestOthers || !targetMoves(run)) return {};
    Problem others;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (k >= run.begin && k < run.end) continue;
      others.add(row(k), samples_[order_[k]]);
    }
    const std::optional<Consensus> without = solve(thinned(cell_, others.observations, others.samples, kSearchedRows), 2);
    if (!without) return {};
    const Registration& registration = without->fit.cell.registration;
    const Misfit misfit = misfitIn(cell_, observations_);
    std::vector<double> stuck, free;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      (k >= run.begin && k < run.end ? stuck : free).push_back(misfit(registration, samples_[order_[k]]));
    }
    const double of_stuck = median(stuck), of_others = median(free);
    if (!(of_stuck > kBeside * of_others)) return {};
    const bool to_the_end = run.end == order_.size();
    const std::string until = to_the_end ? "from this row on" : fmt::format("for {} rows from this one on", run.size());
    return StuckReadings{fmt::format("{} {}, but the target moves on: expected the reading of each moment", what, until),
                         row(run.begin).sample, of_stuck, of_others};
  }

  const Cell& cell_;
  const std::vector<Observation>& observations_;
  const std::vector<HypothesisSample>& samples_;
  std::vector<std::size_t> order_;  ///< observations by their samples
};

}  // namespace

std::optional<StuckReadings> findStuckReadings(const Cell& cell, const std::vector<Observation>& observations,
                                               const std::vector<HypothesisSample>& samples) {
  return Finder(cell, observations, samples).find();
}

std::string copiedColumns(const std::vector<Observation>& observations) {
  if (observations.size() < kFewestOthers) return "";
  const Eigen::Index joints = observations.front().q.size();
  for (Eigen::Index a = 0; a < joints; ++a) {
    for (Eigen::Index b = a + 1; b < joints; ++b) {
      const bool same = std::all_of(observations.begin(), observations.end(), [&](const Observation& one) { return one.q(a) == one.q(b); });
      const bool moves = std::any_of(observations.begin(), observations.end(),
                                     [&](const Observation& one) { return one.q(a) != observations.front().q(a); });
      if (same && moves)
        return fmt::format("q{} and q{} hold the same readings in every row: expected the readings of two joints", a + 1, b + 1);
    }
  }
  return "";
}

}  // namespace poecal
