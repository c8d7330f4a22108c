#include "poecal/identification/errors.hpp"

#include <algorithm>
#include <cmath>

#include "poecal/cell/adjustment.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {

LengthSummary summarise(const std::vector<double>& lengths) {
  if (lengths.empty()) return {};
  return {mean(lengths), median(lengths), rms(lengths), *std::max_element(lengths.begin(), lengths.end())};
}

void ErrorCollector::add(const Cell& cell, const Observation& observation, const Eigen::Isometry3d* T_camera_target) {
  double square = 0.0;
  for (const UnitResidual& unit : residuals(cell, observation)) {
    square += unit.squared_norm;
    if (observation.pose) {
      position_.push_back(unit.residual.tail<3>().norm());
      if (!observation.pose->position_only) rotation_.push_back(unit.residual.head<3>().norm());
    } else if (unit.residual.allFinite()) {
      px_.push_back(unit.residual.norm());
    }
  }
  squares_.push_back(square);
  if (T_camera_target == nullptr) return;
  const Vector6d e = poseDifference(cell.registration.baseFlange(*T_camera_target), modelFlange(cell, observation));
  rotation_.push_back(e.head<3>().norm());
  position_.push_back(e.tail<3>().norm());
}

ErrorSummary ErrorCollector::summary() const {
  ErrorSummary summary;
  summary.poses = static_cast<int>(squares_.size());
  summary.corners = static_cast<int>(px_.size());
  summary.px = summarise(px_);
  summary.position = summarise(position_);
  summary.rotation = summarise(rotation_);
  return summary;
}

}  // namespace poecal
