#include "detection/line_tally.hpp"

#include <algorithm>

namespace poecal {

void LineTally::add(const Eigen::Vector2d& uv, const Eigen::Vector2d& slope, double residual) {
  const std::size_t half = pulls_.size() / 2;
  for (const Eigen::Index axis : {0, 1}) {
    if (slope(axis) == 0.0) continue;
    const auto line = static_cast<std::size_t>(std::clamp(uv(axis) + 0.5, 0.0, static_cast<double>(half - 1)));
    Pull& pull = pulls_[axis == 0 ? line : half + line];
    pull.score += slope(axis) * residual;
    pull.information += slope(axis) * slope(axis);
  }
}

double LineTally::coherence(double variance) const {
  constexpr double kFitted = 8.0;
  double sum = 0.0, lines = 0.0, most = 0.0;
  for (const Pull& pull : pulls_) most = std::max(most, pull.information);
  for (const Pull& pull : pulls_) {
    if (!(pull.information > 0.01 * most)) continue;
    sum += pull.score * pull.score / pull.information;
    lines += 1.0;
  }
  return lines > kFitted ? sum / variance / (lines - kFitted) : 1.0;
}

}  // namespace poecal
