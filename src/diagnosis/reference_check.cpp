#include "diagnosis/reference_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "poecal/cell/adjustment.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr double kMost = 0.9;
constexpr double kFarther = 10.0, kPixels = 10.0;

/// Of each picture that shows the reference, how far its corners are from the middle of what all pictures show of them [px].
std::vector<double> wayOfReference(const std::vector<Observation>& observations) {
  std::map<PointId, std::pair<std::vector<double>, std::vector<double>>> seen;
  for (const Observation& observation : observations) {
    for (const CornerMeasurement& corner : observation.reference) {
      seen[corner.id].first.push_back(corner.px.x());
      seen[corner.id].second.push_back(corner.px.y());
    }
  }
  std::map<PointId, Eigen::Vector2d> middle;
  for (const auto& [id, places] : seen) middle[id] = {median(places.first), median(places.second)};
  std::vector<double> ways;
  for (const Observation& observation : observations) {
    if (observation.reference.empty()) continue;
    double sum = 0.0;
    for (const CornerMeasurement& corner : observation.reference) sum += (corner.px - middle.at(corner.id)).norm();
    ways.push_back(sum / static_cast<double>(observation.reference.size()));
  }
  return ways;
}

/// How far the target is from where the arm puts it [px].
std::vector<double> wayOfTarget(const Cell& identified, const std::vector<Observation>& observations) {
  std::vector<double> ways;
  for (const Observation& observation : observations) {
    double squares = 0.0;
    const std::vector<UnitResidual> units = residuals(identified, observation);
    for (const UnitResidual& unit : units) squares += unit.residual.squaredNorm();
    if (!units.empty()) ways.push_back(std::sqrt(squares / static_cast<double>(units.size())));
  }
  return ways;
}

double mostOf(std::vector<double> ways) {
  const auto place = ways.begin() + static_cast<std::ptrdiff_t>(kMost * static_cast<double>(ways.size() - 1));
  std::nth_element(ways.begin(), place, ways.end());
  return *place;
}

}  // namespace

std::string referenceContradiction(const Cell& identified, const std::vector<Observation>& observations) {
  if (identified.registration.setup != Setup::kEyeToHand) return "";
  const std::vector<double> reference = wayOfReference(observations);
  if (reference.empty()) return "";
  const std::vector<double> target = wayOfTarget(identified, observations);
  if (target.empty()) return "";
  const double way = mostOf(reference), residual = mostOf(target);
  if (!(way > kPixels + kFarther * residual)) return "";
  return fmt::format(
      "reference: its corners move by {:.0f} px while the target stays within {:.2g} px of where the arm puts it: it does not "
      "stand still beside the arm, and is not used",
      way, residual);
}

}  // namespace poecal
