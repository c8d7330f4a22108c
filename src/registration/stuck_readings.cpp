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
    std::optional<StuckReadings> found = judgedRun("the readings stay", frozen);
    for (Eigen::Index joint = 0; joint < joints && !found; ++joint) {
      const RowRun run = longestRun(order_.size(), [&](std::size_t k) { return row(k).q(joint) == row(k - 1).q(joint); });
      if (comeBack(order_.size(), run, [&](std::size_t k) { return row(k).q(joint); })) continue;
      found = judgedRun(fmt::format("q{} stays at exactly {:.6g}", joint + 1, row(run.begin).q(joint)), run);
    }
    return found ? found : judgedRepeats();
  }

 private:
  const Observation& row(std::size_t k) const { return observations_[order_[k]]; }
  const Eigen::Isometry3d& poseAt(std::size_t k) const { return samples_[order_[k]].T_near_far; }

  /// Whether the target is seen to have moved since the row before; shots of one pose show it where it was.
  bool targetMoved(std::size_t k) const {
    constexpr double kMovedPx = 5.0, kMoved = 5e-3;  // far beyond what poses come back by, in pictures and in metres
    const Observation &here = row(k), &before = row(k - 1);
    if (here.pose && before.pose) {
      return (here.pose->T_camera_target.translation() - before.pose->T_camera_target.translation()).norm() > kMoved;
    }
    std::map<PointId, Eigen::Vector2d> seen;
    for (const CornerMeasurement& corner : before.corners) seen[corner.id] = corner.px;
    double farthest = 0.0;
    for (const CornerMeasurement& corner : here.corners) {
      const auto same = seen.find(corner.id);
      if (same != seen.end()) farthest = std::max(farthest, (corner.px - same->second).norm());
    }
    return farthest > kMovedPx;
  }

  bool targetMoves(const RowRun& run) const {
    std::size_t moved = 0;
    for (std::size_t k = run.begin + 1; k < run.end; ++k) moved += targetMoved(k);
    return 2 * moved + 1 > run.size();
  }

  std::optional<StuckReadings> judgedRun(const std::string& what, const RowRun& run) const {
    if (run.size() < kFewestStill || !targetMoves(run)) return {};
    std::vector<bool> stuck(order_.size(), false);
    std::fill(stuck.begin() + static_cast<std::ptrdiff_t>(run.begin), stuck.begin() + static_cast<std::ptrdiff_t>(run.end), true);
    const std::string until = run.end == order_.size() ? "from this row on" : fmt::format("for {} rows from this one on", run.size());
    return judged(fmt::format("{} {}, but the target moves on", what, until), stuck);
  }

  /// Rows that hold the reading of the row before though the target moved since: a logger that is slower than the camera.
  std::optional<StuckReadings> judgedRepeats() const {
    constexpr std::size_t kMany = 10;  // one in so many
    std::vector<bool> stuck(order_.size(), false);
    for (std::size_t k = 1; k < order_.size(); ++k) {
      stuck[k] = samePose(poseAt(k), poseAt(k - 1)) && row(k).q == row(k - 1).q && targetMoved(k);
    }
    const auto count = static_cast<std::size_t>(std::count(stuck.begin(), stuck.end(), true));
    if (count < kFewestStill || kMany * count < order_.size()) return {};
    return judged(
        fmt::format("{} rows, this one the first, hold exactly the reading of the row before, but the target moved in between", count),
        stuck);
  }

  /// @param stuck  rows of which that is believed.
  std::optional<StuckReadings> judged(const std::string& what, const std::vector<bool>& stuck) const {
    Problem others;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (!stuck[k]) others.add(row(k), samples_[order_[k]]);
    }
    if (others.observations.size() < kFewestOthers) return {};
    const std::optional<Consensus> without = solve(thinned(cell_, others.observations, others.samples, kSearchedRows), 2);
    if (!without) return {};
    const Registration& registration = without->fit.cell.registration;
    const Misfit misfit = misfitIn(cell_, observations_);
    std::vector<double> of_stuck, of_others;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      (stuck[k] ? of_stuck : of_others).push_back(misfit(registration, samples_[order_[k]]));
    }
    const double left = median(of_stuck), others_left = median(of_others);
    if (!(left > kBeside * others_left)) return {};
    const auto first = static_cast<std::size_t>(std::find(stuck.begin(), stuck.end(), true) - stuck.begin());
    return StuckReadings{what + ": expected the reading of each moment", row(first).sample, left, others_left};
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
