#include "registration/plausibility.hpp"

#include <cmath>
#include <map>

#include <fmt/format.h>

namespace poecal {
namespace {

// A mistake explains the pictures where undoing it leaves this share of the misfit.
constexpr double kExplains = 0.3;

}  // namespace

double mirroredShare(const std::vector<Observation>& observations) {
  int whole = 0, mirrored = 0;
  for (const Observation& observation : observations) {
    std::map<int, std::map<int, Eigen::Vector2d>> tags;
    for (const CornerMeasurement& corner : observation.corners) {
      if (corner.id.tag >= 0) tags[corner.id.tag][corner.id.corner] = corner.px;
    }
    for (const auto& [tag, corners] : tags) {
      if (corners.size() != 4) continue;
      double twice_area = 0.0;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector2d& a = corners.at(k);
        const Eigen::Vector2d& b = corners.at((k + 1) % 4);
        twice_area += a.x() * b.y() - a.y() * b.x();
      }
      ++whole;
      mirrored += twice_area > 0.0;  // v points down: clockwise to the eye is positive
    }
  }
  return whole > 0 ? static_cast<double>(mirrored) / whole : 0.0;
}

std::optional<std::string> suspectedMistake(const Cell& cell, const std::vector<Observation>& observations, double misfit_px,
                                            double (*misfitOf)(const Cell&, const std::vector<Observation>&)) {
  const auto explains = [&](const Cell& altered_cell, const std::vector<Observation>& altered) {
    return misfitOf(altered_cell, altered) < kExplains * misfit_px;
  };
  if (cell.arm) {
    std::vector<Observation> radians = observations;
    for (Observation& observation : radians) {
      for (int k = 0; k < cell.arm->jointCount(); ++k) {
        if (cell.arm->joints[static_cast<std::size_t>(k)].type == JointType::kRevolute) observation.q(k) *= M_PI / 180.0;
      }
    }
    if (explains(cell, radians)) return "joint readings that look like degrees, expected radians";
  }
  Cell other = cell;
  const bool to_hand = cell.registration.setup == Setup::kEyeToHand;
  other.registration.setup = to_hand ? Setup::kEyeInHand : Setup::kEyeToHand;
  if (explains(other, observations)) {
    return fmt::format("a capture that looks like setup: {}, stated is {}", setupName(other.registration.setup),
                       setupName(cell.registration.setup));
  }
  return std::nullopt;
}

}  // namespace poecal
