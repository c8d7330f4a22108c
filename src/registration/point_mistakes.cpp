// Mistakes in a target that lists single points.
#include <map>

#include <fmt/format.h>

#include "registration/mistakes.hpp"
#include "registration/stray_points.hpp"

namespace poecal {
namespace {

constexpr std::size_t kMostPoints = 12;  // sixty-six pairs are tried within a second

/// The points that are listed, by their numbers; empty where the target is one of tags or a board.
std::map<int, Eigen::Vector3d> listedPoints(const std::vector<Observation>& observations) {
  std::map<int, Eigen::Vector3d> points;
  for (const auto& [id, point] : pointsSeen(observations)) {
    if (id.tag < 0 || id.corner != 0) return {};
    points[id.tag] = point;
  }
  return points;
}

/// The points as they may be instead.
Mistake mistakeOfPoints(std::string text, std::map<int, Eigen::Vector3d> points) {
  return {std::move(text), InputPart::kTarget, [points = std::move(points)](Problem& changed) {
            for (Observation& observation : changed.observations) {
              for (CornerMeasurement& corner : observation.corners) corner.p_target = points.at(corner.id.tag);
            }
            renewPictures(changed);
          }};
}

}  // namespace

std::vector<Mistake> pointMistakes(const Problem& problem, const std::vector<Observation>& all) {
  const std::map<int, Eigen::Vector3d> stated = listedPoints(all);
  std::vector<Mistake> mistakes;
  if (stated.size() < 4 || stated.size() > kMostPoints) return mistakes;
  for (auto a = stated.begin(); a != stated.end(); ++a) {
    for (auto b = std::next(a); b != stated.end(); ++b) {
      std::map<int, Eigen::Vector3d> exchanged = stated;
      std::swap(exchanged[a->first], exchanged[b->first]);
      mistakes.push_back(mistakeOfPoints(fmt::format("the points {} and {} look exchanged", a->first, b->first), std::move(exchanged)));
    }
  }
  // With one axis reversed, or two exchanged, points in space are their mirror image, and no pose makes one of the other.
  std::map<int, Eigen::Vector3d> mirrored = stated;
  for (auto& [id, p] : mirrored) p.x() = -p.x();
  mistakes.push_back(mistakeOfPoints("the points look mirrored: one axis has the wrong sign, or two are exchanged", std::move(mirrored)));
  for (const auto& [id, p] : stated) {
    const auto place = placeByTheOthers(problem, {id, 0}, {{id, 0}}, p);
    if (!place) continue;
    std::map<int, Eigen::Vector3d> moved = stated;
    moved[id] = *place;
    mistakes.push_back(mistakeOfPoints(fmt::format("the point {} looks to lie at [{:.4f}, {:.4f}, {:.4f}], {:.1f} mm from its stated place",
                                                   id, place->x(), place->y(), place->z(), 1e3 * (*place - p).norm()),
                                       std::move(moved)));
  }
  return mistakes;
}

}  // namespace poecal
