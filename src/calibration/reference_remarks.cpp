#include "calibration/reference_remarks.hpp"

#include <map>

#include <fmt/format.h>

#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr std::size_t kFewest = 4;  // as a diagnosis needs them
// A camera that slips moves the reference once, one that drifts or sways by less than this from picture to picture.
constexpr double kStill = 5.0;  // [px]

}  // namespace

std::vector<std::string> remarksOnReference(const std::vector<Observation>& observations) {
  std::map<PointId, Eigen::Vector2d> before;
  std::vector<double> steps;
  std::size_t pictures = 0;
  for (const Observation& observation : observations) {
    pictures += !observation.reference.empty();
    for (const CornerMeasurement& corner : observation.reference) {
      const auto last = before.find(corner.id);
      if (last != before.end()) steps.push_back((corner.px - last->second).norm());
      before[corner.id] = corner.px;
    }
  }
  if (pictures < kFewest) {
    return {fmt::format("reference: is seen in {} of {} pictures, {} are needed: it is not used", pictures, observations.size(), kFewest)};
  }
  const double step = steps.empty() ? 0.0 : median(steps);
  if (step <= kStill) return {};
  return {
      fmt::format("reference: its corners move by {:.0f} px from picture to picture, expected tags that stand still beside the arm", step)};
}

}  // namespace poecal
