// Points of a target that are not where it has them.
#include "registration/stray_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/random.hpp"
#include "poecal/registration/implausible.hpp"
#include "poecal/registration/target_pose.hpp"

namespace poecal {
namespace {

constexpr std::size_t kFewestPictures = 4;
constexpr std::size_t kPictures = 12;      // each is posed anew in every trial
constexpr std::size_t kFewestPoints = 12;  // of fewer ones each is tried by itself
constexpr double kMostLeftOut = 1.0 / 3.0;
constexpr double kRest = 0.2;     // of what was left
constexpr double kFarOff = 0.25;  // of the distance to the nearest point
constexpr int kSteps = 10;
constexpr std::size_t kTogether = 6;  // a pose of them is no coincidence
constexpr int kTrials = 50;           // with a third of the points off, one in twelve is of none of them

using Points = std::map<PointId, Eigen::Vector3d>;

/// Whether there are tags, which one_tag.hpp looks at.
bool hasTags(const Points& points) {
  return std::any_of(points.begin(), points.end(), [](const auto& point) { return point.first.tag >= 0 && point.first.corner > 0; });
}

Observation without(const Observation& observation, const std::set<PointId>& left_out) {
  Observation others = observation;
  std::erase_if(others.corners, [&](const CornerMeasurement& corner) { return left_out.contains(corner.id); });
  return others;
}

/// Mean squares of what poses by the points that are not left out leave of each point over the pictures [px^2].
std::map<PointId, double> leftOfEach(const Problem& problem, const std::set<PointId>& left_out) {
  std::map<PointId, std::pair<double, int>> sums;
  for (const Observation& observation : problem.observations) {
    const std::vector<TargetPose> poses = targetPoses(*problem.cell.camera, without(observation, left_out));
    if (poses.empty()) continue;
    for (const CornerMeasurement& corner : observation.corners) {
      const auto px = project(*problem.cell.camera, poses.front().T_camera_target * corner.p_target);
      if (!px) continue;
      auto& [squares, count] = sums[corner.id];
      squares += (corner.px - *px).squaredNorm();
      ++count;
    }
  }
  std::map<PointId, double> left;
  for (const auto& [id, sum] : sums) left[id] = sum.first / sum.second;
  return left;
}

/// Root mean square of those that are not left out.
double rmsOf(const std::map<PointId, double>& left, const std::set<PointId>& left_out) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& [id, squares] : left) {
    if (left_out.contains(id)) continue;
    sum += squares;
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / static_cast<double>(count));
}

/// All but the `kept` points of which least is left.
std::set<PointId> farthest(const std::map<PointId, double>& left, std::size_t kept) {
  std::vector<std::pair<double, PointId>> order;
  for (const auto& [id, squares] : left) order.emplace_back(squares, id);
  std::sort(order.begin(), order.end());
  std::set<PointId> others;
  for (std::size_t k = kept; k < order.size(); ++k) others.insert(order[k].second);
  return others;
}

/// Points without which the others fit, by poses of a few of them at a time: whatever many of them are off by drags a pose of all along.
std::set<PointId> strayPoints(const Problem& problem, const Points& points) {
  const auto kept = points.size() - static_cast<std::size_t>(kMostLeftOut * static_cast<double>(points.size()));
  std::vector<PointId> ids;
  for (const auto& [id, p] : points) ids.push_back(id);
  Rng rng(1);
  std::set<PointId> best;
  double least = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < kTrials; ++trial) {
    for (std::size_t k = 0; k < kTogether; ++k) std::swap(ids[k], ids[k + rng.below(ids.size() - k)]);
    const std::map<PointId, double> by_few = leftOfEach(problem, std::set<PointId>(ids.begin() + kTogether, ids.end()));
    if (by_few.size() <= kept) continue;
    const std::set<PointId> left_out = farthest(by_few, kept);
    const double rms = rmsOf(by_few, left_out);
    if (rms >= least) continue;
    least = rms;
    best = left_out;
  }
  if (best.empty()) return best;
  // Of those that were left out some are where they should be.
  const std::map<PointId, double> left = leftOfEach(problem, best);
  const double limit = kBeside * kBeside * std::pow(rmsOf(left, best), 2);
  std::erase_if(best, [&](const PointId& id) { return !left.contains(id) || left.at(id) <= limit; });
  return best;
}

double distanceToNearest(const Points& points, PointId id) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [other, p] : points) {
    if (other != id) least = std::min(least, (p - points.at(id)).norm());
  }
  return least;
}

/// "28 to 34", "3, 17".
std::string numbersText(const std::set<PointId>& points) {
  std::vector<int> numbers;
  for (const PointId& id : points) numbers.push_back(id.tag < 0 ? id.corner : id.tag);
  std::sort(numbers.begin(), numbers.end());
  const bool run = numbers.size() > 2 && numbers.back() - numbers.front() + 1 == static_cast<int>(numbers.size());
  if (run) return fmt::format("{} to {}", numbers.front(), numbers.back());
  return fmt::format("{}", fmt::join(numbers, ", "));
}

}  // namespace

std::optional<Eigen::Vector3d> placeByTheOthers(const Problem& problem, PointId point, const std::set<PointId>& left_out,
                                                Eigen::Vector3d p) {
  std::vector<std::pair<Eigen::Isometry3d, Eigen::Vector2d>> sights;
  for (const Observation& observation : problem.observations) {
    const auto seen = std::find_if(observation.corners.begin(), observation.corners.end(),
                                   [&](const CornerMeasurement& corner) { return corner.id == point; });
    if (seen == observation.corners.end()) continue;
    const std::vector<TargetPose> poses = targetPoses(*problem.cell.camera, without(observation, left_out));
    if (!poses.empty()) sights.emplace_back(poses.front().T_camera_target, seen->px);
  }
  if (sights.size() < kFewestPictures) return std::nullopt;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const auto& [T, px] : sights) {
      const auto seen = projectWithJacobians(*problem.cell.camera, T * p);
      if (!seen) continue;
      const Eigen::Matrix<double, 2, 3> J = seen->J_px_p * T.linear();
      A += J.transpose() * J;
      b += J.transpose() * (px - seen->px);
    }
    const Eigen::Vector3d change = A.ldlt().solve(b);
    if (!change.allFinite()) return std::nullopt;
    p += change;
  }
  return p;
}

void requireEachPointFits(const Cell& cell, const std::vector<Observation>& observations) {
  const Points points = pointsSeen(observations);
  if (hasTags(points) || points.size() < kFewestPoints) return;
  const Problem few = evenly(cell, observations, kPictures);
  const double all = rmsOf(leftOfEach(few, {}), {});
  const std::set<PointId> left_out = strayPoints(few, points);
  if (left_out.empty()) return;
  const double rest = rmsOf(leftOfEach(few, left_out), left_out);
  if (!(rest <= kRest * all)) return;
  double most = 0.0;
  for (const PointId& id : left_out) {
    const auto place = placeByTheOthers(few, id, left_out, points.at(id));
    if (!place) return;
    const double off = (*place - points.at(id)).norm();
    if (off < kFarOff * distanceToNearest(points, id)) return;
    most = std::max(most, off);
  }
  const bool board = points.begin()->first.tag < 0, one = left_out.size() == 1;
  throw ImplausibleCapture(
      fmt::format(
          "the {}{} {} of the target {} up to {:.1f} mm from {} (with a pose of its own in each picture the others fit to {:.3g} px, "
          "all together to {:.3g} px): expected {}",
          board ? "corner" : "point", one ? "" : "s", numbersText(left_out), one ? "lies" : "lie", 1e3 * most,
          one ? "its place" : "their places", rest, all,
          board ? "every corner under the number that the board gives it" : "the points where the target has them"),
      board ? InputPart::kDetections : InputPart::kTarget);
}

}  // namespace poecal
