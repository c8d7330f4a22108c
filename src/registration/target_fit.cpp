// The target that a user states against the corners that the pictures show.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "poecal/core/statistics.hpp"
#include "registration/mistakes.hpp"
#include "registration/one_tag.hpp"
#include "registration/stray_points.hpp"
#include "registration/target_fit.hpp"

namespace poecal {
namespace {

// Up to this share of the target's extent in the picture, and so many pixels, noise or a usual lens may be all that a free pose leaves.
constexpr double kShareOfExtent = 0.01;
constexpr double kPixels = 1.0;
// Enough to judge a change of the target, few enough to judge sixty within a second.
constexpr std::size_t kRows = 20, kTags = 6;
// A change of the target explains it where it leaves this share.
constexpr double kMends = 0.3;
// And no more than so many times what may be all that is usual.
constexpr double kUsual = 2.0;
// Factors on the distance of the tags that are tried.
constexpr double kFarthest = 1.0, kStep = 0.05;
constexpr std::size_t kListed = 8;  // tags of a target that lists each of them
// Beyond this share of the target's extent no lens and no bend is what a free pose leaves.
constexpr double kOfNoTarget = 0.1;
constexpr int kNearest = 2;  // steps; closer to what is stated it is a tag that was mounted badly, which is for the diagnosis to say

/// Centres of all tags that are seen, of their corners as stated.
std::map<int, Eigen::Vector3d> tagCentres(const std::vector<Observation>& observations) {
  std::map<int, std::pair<Eigen::Vector3d, int>> sums;
  for (const auto& [id, point] : pointsSeen(observations)) {
    auto [sum, is_new] = sums.try_emplace(id.tag, Eigen::Vector3d::Zero(), 0);
    sum->second.first += point;
    ++sum->second.second;
  }
  std::map<int, Eigen::Vector3d> centres;
  for (const auto& [tag, sum] : sums) {
    if (sum.second == 4) centres[tag] = sum.first / 4.0;
  }
  return centres;
}

/// Every tag as it is, its centre moved. @param from, to  centres of the same tags.
Mistake mistakeOfCentres(std::string text, std::map<int, Eigen::Vector3d> from, std::map<int, Eigen::Vector3d> to) {
  return {std::move(text), InputPart::kTarget, [from = std::move(from), to = std::move(to)](Problem& changed) {
            for (Observation& observation : changed.observations) {
              std::erase_if(observation.corners, [&](CornerMeasurement& corner) {
                const auto centre = from.find(corner.id.tag);
                if (centre == from.end()) return true;
                corner.p_target += to.at(corner.id.tag) - centre->second;
                return false;
              });
            }
            renewPictures(changed);
          }};
}

/// The centres mapped about the middle of them all.
Mistake mistakeOfLayout(std::string text, const std::map<int, Eigen::Vector3d>& centres, const Eigen::Matrix3d& map) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& [tag, centre] : centres) middle += centre / static_cast<double>(centres.size());
  std::map<int, Eigen::Vector3d> mapped = centres;
  for (auto& [tag, centre] : mapped) centre = middle + map * (centre - middle);
  return mistakeOfCentres(std::move(text), centres, std::move(mapped));
}

/// The tags' numbers counted over a grid of as many columns as there are rows; nothing where the tags are no full grid.
std::optional<std::map<int, Eigen::Vector3d>> gridTheOtherWay(const std::map<int, Eigen::Vector3d>& centres) {
  const auto different = [&](int axis) {
    std::vector<double> values;
    for (const auto& [tag, centre] : centres) values.push_back(centre(axis));
    return distinctPlaces(std::move(values));
  };
  const std::vector<double> x = different(0), y = different(1);
  const std::size_t columns = x.size(), rows = y.size();
  if (columns == rows || columns < 2 || rows < 2 || columns * rows != centres.size()) return {};
  const double dx = (x.back() - x.front()) / static_cast<double>(columns - 1), dy = (y.back() - y.front()) / static_cast<double>(rows - 1);
  std::map<int, Eigen::Vector3d> other = centres;
  std::size_t place = 0;
  for (auto& [tag, centre] : other) {
    centre.head<2>() << dx * static_cast<double>(place % rows), dy * static_cast<double>(place / rows);
    ++place;
  }
  return other;
}

/// Median over the observations of the diagonal of what is seen [px].
double extentInPictures(const std::vector<Observation>& observations) {
  std::vector<double> extents;
  for (const Observation& observation : observations) {
    if (observation.corners.empty()) continue;
    Eigen::Vector2d low = observation.corners.front().px, high = low;
    for (const CornerMeasurement& corner : observation.corners) {
      low = low.cwiseMin(corner.px);
      high = high.cwiseMax(corner.px);
    }
    extents.push_back((high - low).norm());
  }
  return extents.empty() ? 0.0 : median(extents);
}

/// Some observations evenly over the series, each with some tags, evenly over those whose four corners it shows.
Problem wholeTags(const Cell& cell, const std::vector<Observation>& observations) {
  Problem few = evenly(cell, observations, kRows);
  for (Observation& observation : few.observations) {
    std::map<int, int> seen;
    for (const CornerMeasurement& corner : observation.corners) ++seen[corner.id.tag];
    std::vector<int> whole;
    for (const auto& [tag, corners] : seen) {
      if (tag >= 0 && corners == 4) whole.push_back(tag);
    }
    std::set<int> chosen;
    const std::size_t tags = std::min(kTags, whole.size());
    for (std::size_t k = 0; k < tags; ++k) chosen.insert(whole[k * whole.size() / tags]);
    std::erase_if(observation.corners, [&](const CornerMeasurement& corner) { return !chosen.contains(corner.id.tag); });
  }
  std::erase_if(few.observations, [](const Observation& observation) { return observation.corners.empty(); });
  renewPictures(few);
  return few;
}

/// What free poses leave (median); infinity where a quarter of the pictures that show four corners have none.
double freeOrNone(const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples) {
  std::size_t posed = 0, seen = 0;
  for (const HypothesisSample& sample : samples) {
    seen += observations[sample.observation].corners.size() >= 4;
    posed += !sample.candidates.empty();
  }
  return 4 * posed <= 3 * seen ? std::numeric_limits<double>::infinity() : freeMisfit(samples);
}

/// Corners of a board without tags, all of them seen, by their numbers.
std::map<int, Eigen::Vector3d> boardCorners(const std::vector<Observation>& observations) {
  std::map<int, Eigen::Vector3d> corners;
  for (const auto& [id, point] : pointsSeen(observations)) {
    if (id.tag < 0) corners[id.corner] = point;
  }
  return corners;
}

/// A board whose corners were counted over as many columns as it has rows: with columns and rows exchanged in its file.
void requireGridFits(const Cell& cell, const std::vector<Observation>& observations) {
  const std::map<int, Eigen::Vector3d> stated = boardCorners(observations);
  const std::optional<std::map<int, Eigen::Vector3d>> other = gridTheOtherWay(stated);
  if (!other) return;
  Problem few = evenly(cell, observations, kRows);
  renewPictures(few);
  Problem altered = few;
  for (Observation& observation : altered.observations) {
    for (CornerMeasurement& corner : observation.corners) corner.p_target = other->at(corner.id.corner);
  }
  renewPictures(altered);
  const double as_stated = freeOrNone(few.observations, few.samples), exchanged = freeOrNone(altered.observations, altered.samples);
  const double usual = std::max(kPixels, kShareOfExtent * extentInPictures(observations));
  if (!(exchanged <= kMends * as_stated) || !(exchanged <= kUsual * usual)) return;
  throw ImplausibleCapture(
      fmt::format("the board's columns and rows look exchanged (so, with a pose of its own in each picture it fits to {:.3g} px instead of "
                  "{})",
                  exchanged, std::isfinite(as_stated) ? fmt::format("{:.3g} px", as_stated) : "not at all"),
      InputPart::kTarget);
}

struct BetterTarget {
  std::string text;
  InputPart part = InputPart::kTarget;
  double left = 0.0;
  std::string other = "";  ///< another mistake that explains as much
};

/// Corners, tags or points in another order, or another distance of them. @param usual  what a usual lens may leave [px].
void requireLayoutFits(const Cell& cell, const std::vector<Observation>& observations, double usual) {
  Problem few = wholeTags(cell, observations);
  if (few.observations.size() < 4) {
    few = evenly(cell, observations, kRows);
    renewPictures(few);
  }
  const double stated = freeOrNone(few.observations, few.samples);
  std::optional<BetterTarget> best;
  for (const std::vector<Mistake>& kind :
       std::array{layoutMistakes(few, observations), cornerMistakes(few), pointMistakes(few, observations)}) {
    for (const Mistake& mistake : kind) {
      Problem altered = few;
      mistake.undo(altered);
      const double left = freeOrNone(altered.observations, altered.samples);
      if (!(left <= kMends * stated) || !(left <= kUsual * usual)) continue;
      if (!best || left < kClearlyBetter * best->left) {
        best = {mistake.text, mistake.part, left};
      } else if (best->other.empty() && left < kAsGood * best->left) {
        best->other = mistake.text;
      }
    }
  }
  if (!best) return;
  throw ImplausibleCapture(
      fmt::format("{} (with a pose of its own in each picture the target then fits to {:.3g} px instead of {}{})", best->text, best->left,
                  std::isfinite(stated) ? fmt::format("{:.3g} px", stated) : "not at all", asLikely(best->other)),
      best->part);
}

}  // namespace

std::vector<Mistake> cornerMistakes(const Problem& problem) {
  std::vector<Mistake> mistakes;
  if (problem.observations.front().pose || problem.observations.front().corners.front().id.tag < 0) return mistakes;
  std::array<int, 4> order{0, 1, 2, 3};
  while (std::next_permutation(order.begin(), order.end())) {
    mistakes.push_back({fmt::format("the corners of the tags look to be in another order: 0, 1, 2, 3 are {}, {}, {}, {}", order[0],
                                    order[1], order[2], order[3]),
                        InputPart::kDetections, [order](Problem& changed) {
                          for (Observation& observation : changed.observations) {
                            std::map<PointId, Eigen::Vector3d> points;
                            for (const CornerMeasurement& corner : observation.corners) points[corner.id] = corner.p_target;
                            std::erase_if(observation.corners, [&](CornerMeasurement& corner) {
                              const int place = corner.id.corner;
                              if (place < 0 || place > 3) return true;
                              corner.id.corner = order[static_cast<std::size_t>(place)];
                              const auto point = points.find(corner.id);
                              if (point == points.end()) return true;
                              corner.p_target = point->second;
                              return false;
                            });
                          }
                          renewPictures(changed);
                        }});
  }
  return mistakes;
}

std::vector<Mistake> layoutMistakes(const Problem& problem, const std::vector<Observation>& all) {
  std::vector<Mistake> mistakes;
  if (problem.observations.front().pose || problem.observations.front().corners.front().id.tag < 0) return mistakes;
  const std::map<int, Eigen::Vector3d> centres = tagCentres(all);
  if (centres.size() < 2) return mistakes;
  const auto add = [&](std::string text, const Eigen::Matrix3d& map) {
    mistakes.push_back(mistakeOfLayout(std::move(text), centres, map));
  };
  const Eigen::Matrix3d mirror_x = Eigen::Vector3d(-1, 1, 1).asDiagonal(), mirror_y = Eigen::Vector3d(1, -1, 1).asDiagonal();
  add("the tags' numbers look to run from right to left", mirror_x);
  add("the tags' numbers look to run from the other end of the columns (top and bottom row exchanged)", mirror_y);
  add("the tags' numbers look to run from the opposite corner", mirror_x * mirror_y);
  Eigen::Matrix3d exchanged = Eigen::Matrix3d::Identity();
  exchanged.topLeftCorner<2, 2>() << 0, 1, 1, 0;
  add("the tags' numbers look to run along the columns first", exchanged);
  if (auto other = gridTheOtherWay(centres)) {
    mistakes.push_back(mistakeOfCentres("the grid's columns and rows look exchanged", centres, std::move(*other)));
  }
  // Of many tags two exchanged ones are no mistake in the file, which counts them in order.
  if (centres.size() > 2 && centres.size() <= kListed) {
    for (auto a = centres.begin(); a != centres.end(); ++a) {
      for (auto b = std::next(a); b != centres.end(); ++b) {
        std::map<int, Eigen::Vector3d> exchanged_tags = centres;
        std::swap(exchanged_tags[a->first], exchanged_tags[b->first]);
        mistakes.push_back(
            mistakeOfCentres(fmt::format("the tags {} and {} look exchanged", a->first, b->first), centres, std::move(exchanged_tags)));
      }
    }
  }
  for (int k = kNearest; k <= static_cast<int>(kFarthest / kStep); ++k) {
    for (const double factor : {std::exp(kStep * k), std::exp(-kStep * k)}) {
      add(fmt::format("the tags look {:.2f} times as far apart, centre to centre, as stated", factor),
          Eigen::Vector3d(factor, factor, 1.0).asDiagonal());
    }
  }
  return mistakes;
}

void requireTargetFits(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples) {
  if (observations.size() < 4 || observations.front().pose) return;
  requireGridFits(cell, observations);
  const double free = freeOrNone(observations, samples), extent = extentInPictures(observations);
  const double usual = std::max(kPixels, kShareOfExtent * extent);
  if (free > usual) requireLayoutFits(cell, observations, usual);
  // After the layout as a whole: seen from a tag whose corners are counted otherwise, another one lies elsewhere.
  requireEachTagFits(cell, observations);
  if (free > usual) requireEachPointFits(cell, observations);
  if (!(free > kOfNoTarget * extent) || free <= usual) return;
  throw ImplausibleCapture(fmt::format("no pose of this target shows the corners as the pictures do (the best leave {} of {:.0f} px from "
                                       "corner to corner): expected the layout, ids and sizes of the printed target",
                                       std::isfinite(free) ? fmt::format("{:.3g}", free) : "all", extent),
                           InputPart::kTarget);
}

}  // namespace poecal
