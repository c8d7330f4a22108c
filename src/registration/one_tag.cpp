#include "registration/one_tag.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "poecal/geometry/se3.hpp"
#include "poecal/registration/implausible.hpp"
#include "poecal/registration/target_pose.hpp"
#include "registration/problem.hpp"

namespace poecal {
namespace {

constexpr std::size_t kFewestTags = 2, kMostTags = 8;
constexpr std::size_t kRows = 16, kFewestRows = 4;
// What no ruler and no printer makes of one tag beside others; turns in radians.
constexpr double kOtherSize = 0.03, kOtherPlace = 0.1, kOtherTurn = 0.1;
// Nearer by than this share of its size it is an effect of the target, which a diagnosis measures where there is an arm.
constexpr double kOtherPlaceOfArms = 0.5;
constexpr double kSurely = 6.0;  // standard deviations
constexpr double kMends = 0.3;   // of what free poses leave as stated
constexpr int kTagCorners = 4;
constexpr double kDegree = 180.0 / M_PI;

/// Change of a tag: size beside 1, shift along its two edges and out of its plane [m], turn about the same three axes [rad].
using Change = Eigen::Matrix<double, 7, 1>;

/// Corners as stated, by tag and number.
using CornersOfTags = std::map<int, std::map<int, Eigen::Vector3d>>;

/// Tags whose four corners a picture shows.
std::set<int> wholeTags(const Observation& observation) {
  std::map<int, int> seen;
  for (const CornerMeasurement& corner : observation.corners) ++seen[corner.id.tag];
  std::set<int> whole;
  for (const auto& [tag, corners] : seen) {
    if (tag >= 0 && corners == kTagCorners) whole.insert(tag);
  }
  return whole;
}

/// A tag as stated: its middle, and unit vectors along its edges and out of its plane.
struct TagPlane {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double size = 0.0;

  static TagPlane of(const std::map<int, Eigen::Vector3d>& corners) {
    TagPlane plane;
    for (const auto& [corner, point] : corners) plane.middle += point / kTagCorners;
    plane.size = (corners.at(1) - corners.at(0)).norm();
    const Eigen::Vector3d along = (corners.at(1) - corners.at(0)).normalized();
    const Eigen::Vector3d up = corners.at(3) - corners.at(0);
    const Eigen::Vector3d across = (up - along * along.dot(up)).normalized();
    plane.axes << along, across, along.cross(across);
    return plane;
  }
  /// d(point) / d(change).
  Eigen::Matrix<double, 3, 7> derivative(const Eigen::Vector3d& point) const {
    Eigen::Matrix<double, 3, 7> J;
    J << (point - middle), axes, -hat(point - middle) * axes;
    return J;
  }
  Eigen::Vector3d changed(const Eigen::Vector3d& point, const Change& change) const {
    return middle + (1.0 + change(0)) * (expSo3(axes * change.tail<3>()) * (point - middle)) + axes * change.segment<3>(1);
  }
};

struct FittedChange {
  Change change = Change::Zero(), sigma = Change::Zero();
};

/// Where a tag may differ: in its plane, which the pose of one other tag shows well, or anywhere.
enum class Within { kPlane, kSpace };

/// What the corners of a tag so changed are off by, in the pose that the other tags give.
std::optional<FittedChange> furtherChange(const Camera& camera, const std::vector<Observation>& rows, int tag, const TagPlane& plane,
                                          const Change& change, Within within) {
  Eigen::Matrix<double, 7, 7> A = Eigen::Matrix<double, 7, 7>::Zero();
  Change b = Change::Zero();
  double squares = 0.0, numbers = 0.0;
  std::size_t used = 0;
  for (const Observation& row : rows) {
    const std::set<int> whole = wholeTags(row);
    if (!whole.contains(tag) || whole.size() < kFewestTags) continue;
    Observation others = row;
    std::erase_if(others.corners, [&](const CornerMeasurement& corner) { return corner.id.tag == tag || !whole.contains(corner.id.tag); });
    const std::vector<TargetPose> poses = targetPoses(camera, others);
    if (poses.empty()) continue;
    ++used;
    const Eigen::Isometry3d& T = poses.front().T_camera_target;
    for (const CornerMeasurement& corner : row.corners) {
      if (corner.id.tag != tag) continue;
      const auto seen = projectWithJacobians(camera, T * plane.changed(corner.p_target, change));
      if (!seen) continue;
      const Eigen::Matrix<double, 2, 7> J = seen->J_px_p * T.linear() * plane.derivative(corner.p_target);
      const Eigen::Vector2d r = corner.px - seen->px;
      A += J.transpose() * J;
      b += J.transpose() * r;
      squares += r.squaredNorm();
      numbers += 2.0;
    }
  }
  if (used < kFewestRows) return std::nullopt;
  constexpr int kOutOfPlane = 3, kWays = 3;  // its shift out of the plane, and both tilts
  if (within == Within::kPlane) {
    A.middleRows<kWays>(kOutOfPlane).setZero();
    A.middleCols<kWays>(kOutOfPlane).setZero();
    A.block<kWays, kWays>(kOutOfPlane, kOutOfPlane).setIdentity();
    b.segment<kWays>(kOutOfPlane).setZero();
    numbers += kWays;
  }
  const Eigen::LDLT<Eigen::Matrix<double, 7, 7>> ldlt(A);
  FittedChange fitted{ldlt.solve(b), {}};
  const double variance = std::max(0.0, squares - fitted.change.dot(b)) / std::max(1.0, numbers - 7.0);
  fitted.sigma = (variance * ldlt.solve(Eigen::Matrix<double, 7, 7>::Identity()).diagonal()).cwiseMax(0.0).cwiseSqrt();
  if (!fitted.change.allFinite() || !fitted.sigma.allFinite()) return std::nullopt;
  return fitted;
}

/// What a tag's corners are off by, as a change of the tag.
std::optional<FittedChange> fitChange(const Camera& camera, const std::vector<Observation>& rows, int tag, const TagPlane& plane,
                                      Within within) {
  const int steps = within == Within::kPlane ? 1 : 3;  // tilts of some tenths of a radian are not linear
  Change change = Change::Zero();
  std::optional<FittedChange> further;
  for (int step = 0; step < steps; ++step) {
    further = furtherChange(camera, rows, tag, plane, change, within);
    if (!further) return std::nullopt;
    change += further->change;
  }
  return FittedChange{change, further->sigma};
}

/// How one tag differs from what is stated.
struct Difference {
  std::string text;       ///< "12.0 % larger than stated, 4.1 mm from its stated place"; empty where it is as stated
  bool is_moved = false;  ///< it lies elsewhere
};

/// @param elsewhere  beyond such a share of its size it lies elsewhere.
Difference describe(const FittedChange& fitted, double size, double elsewhere) {
  const auto surely = [&](Eigen::Index k, double usual) { return std::abs(fitted.change(k)) > std::max(usual, kSurely * fitted.sigma(k)); };
  Difference difference;
  const auto add = [&difference](const std::string& what) { difference.text += (difference.text.empty() ? "" : ", ") + what; };
  if (surely(0, kOtherSize)) {
    const double more = fitted.change(0);
    add(fmt::format("{:.1f} % {} than stated", 100.0 * std::abs(more), more > 0.0 ? "larger" : "smaller"));
  }
  difference.is_moved = surely(1, elsewhere * size) || surely(2, elsewhere * size);
  if (difference.is_moved) add(fmt::format("{:.3g} mm from its stated place", 1e3 * std::hypot(fitted.change(1), fitted.change(2))));
  if (surely(3, kOtherPlace * size)) add(fmt::format("{:.3g} mm out of its stated plane", 1e3 * std::abs(fitted.change(3))));
  if (surely(6, kOtherTurn)) add(fmt::format("turned by {:.3g} degrees", fitted.change(6) * kDegree));
  if (surely(4, kOtherTurn) || surely(5, kOtherTurn)) {
    add(fmt::format("tilted by {:.3g} degrees", std::hypot(fitted.change(4), fitted.change(5)) * kDegree));
  }
  return difference;
}

/// A tag of half or twice its size, farther away than the target is wide or tipped over: the others place it by a pose that is none.
bool isFarFrom(const FittedChange& fitted, const CornersOfTags& tags, const TagPlane& plane) {
  constexpr double kHalf = 0.5, kTipped = 1.0;
  double farthest = 0.0;
  for (const auto& [tag, corners] : tags) {
    for (const auto& [corner, point] : corners) farthest = std::max(farthest, (point - plane.middle).norm());
  }
  return std::abs(fitted.change(0)) > kHalf || fitted.change.segment<3>(1).norm() > farthest ||
         fitted.change.segment<2>(4).norm() > kTipped;
}

std::size_t posed(const Problem& problem) {
  return static_cast<std::size_t>(std::count_if(problem.samples.begin(), problem.samples.end(),
                                                [](const HypothesisSample& sample) { return !sample.candidates.empty(); }));
}

/// The tag that is not as stated, and how; empty where none is.
std::string tagThatDiffers(const Problem& few, const CornersOfTags& tags, Within within) {
  const Cell& cell = few.cell;
  const double stated = freeMisfit(few.samples);
  double least = kMends * stated;
  std::string best;
  for (const auto& [tag, corners] : tags) {
    if (corners.size() != kTagCorners) continue;
    const TagPlane plane = TagPlane::of(corners);
    const auto fitted = fitChange(*cell.camera, few.observations, tag, plane, within);
    if (!fitted) continue;
    const Difference difference = describe(*fitted, plane.size, cell.arm ? kOtherPlaceOfArms : kOtherPlace);
    if (difference.text.empty() || isFarFrom(*fitted, tags, plane)) continue;
    // Of two, one that lies elsewhere says as much of the other: an effect of the target, as none is out of the plane. And one beside a
    // neighbour of another size looks, seen from that, as if it lay elsewhere.
    if (tags.size() == kFewestTags && difference.is_moved) continue;
    Problem altered = few;
    for (Observation& observation : altered.observations) {
      for (CornerMeasurement& corner : observation.corners) {
        if (corner.id.tag == tag) corner.p_target = plane.changed(corner.p_target, fitted->change);
      }
    }
    renewPictures(altered);
    const double left = freeMisfit(altered.samples);
    if (!(left < least) || posed(altered) < posed(few)) continue;
    least = left;
    best = fmt::format(
        "tag {} does not fit the layout of the others: it looks {} (so, the target fits to {:.3g} px instead of {:.3g} with a pose of "
        "its own in each picture)",
        tag, difference.text, left, stated);
  }
  return best;
}

}  // namespace

void requireEachTagFits(const Cell& cell, const std::vector<Observation>& observations) {
  if (!cell.camera || observations.empty() || observations.front().pose) return;
  CornersOfTags tags;
  for (const auto& [id, point] : pointsSeen(observations)) tags[id.tag][id.corner] = point;
  if (tags.size() < kFewestTags || tags.size() > kMostTags || tags.begin()->first < 0) return;
  Problem few = evenly(cell, observations, kRows);
  renewPictures(few);
  for (const Within within : {Within::kPlane, Within::kSpace}) {
    const std::string misfit = tagThatDiffers(few, tags, within);
    if (!misfit.empty()) throw ImplausibleCapture(misfit, InputPart::kTarget);
  }
}

}  // namespace poecal
