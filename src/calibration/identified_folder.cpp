#include "calibration/identified_folder.hpp"

#include <cmath>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// What makes a model one of another cell; empty where nothing does.
std::string difference(const Model& model, const Cell& here, const Measurements& measurements) {
  const Arm &arm = *model.cell.arm, &expected = *here.arm;
  if (arm.jointCount() != expected.jointCount()) {
    return fmt::format("its arm has {} joints, expected the {} of the capture", arm.jointCount(), expected.jointCount());
  }
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    if (arm.joints[k].name != expected.joints[k].name || arm.joints[k].type != expected.joints[k].type) {
      return fmt::format("its joint {} is '{}', expected '{}' as in the capture", k + 1, arm.joints[k].name, expected.joints[k].name);
    }
  }
  if (model.cell.registration.setup != measurements.setup) {
    return fmt::format("its setup is {}, expected {} as in the capture", setupName(model.cell.registration.setup),
                       setupName(measurements.setup));
  }
  if (model.cell.camera && here.camera &&
      (model.cell.camera->width != here.camera->width || model.cell.camera->height != here.camera->height)) {
    return fmt::format("its pictures are {} x {}, expected the {} x {} of the capture", model.cell.camera->width, model.cell.camera->height,
                       here.camera->width, here.camera->height);
  }
  if (!model.target) return "";
  for (const TargetPoint& point : measurements.target.points) {
    const TargetPoint* same = model.target->find(point.id);
    constexpr double kSame = 1e-9;  // [m]
    if (same == nullptr || (same->p_target - point.p_target).norm() > kSame) return "its target is not that of the capture";
  }
  return "";
}

/// Median length of a unit's residual: corners [px] or poses.
double medianResidual(const Cell& cell, const Measurements& measurements) {
  std::vector<double> lengths;
  for (const Observation& observation : measurements.observations) {
    for (const UnitResidual& unit : residuals(cell, observation)) {
      lengths.push_back(std::isfinite(unit.squared_norm) ? std::sqrt(unit.squared_norm) : std::numeric_limits<double>::infinity());
    }
  }
  return median(std::move(lengths));
}

}  // namespace

void requireIdentified(const std::filesystem::path& folder, const Calibration& calibration, const Measurements& measurements) {
  const std::filesystem::path file = folder / "model.yaml";
  const Model model = readModel(file);
  const Cell& here = calibration.identification->model.cell;
  const std::string other = difference(model, here, measurements);
  if (!other.empty()) throw FileError(file, 1, other);
  if (!model.effects.empty()) return;  // a diagnosed model of this cell: what it leaves is not what an identified one leaves
  constexpr double kOfAnother = 3.0;   // methods and options differ by far less
  const double found = medianResidual(here, measurements), given = medianResidual(model.cell, measurements);
  if (given > kOfAnother * found) {
    throw FileError(file, 1,
                    fmt::format("leaves {:.3g} in this capture where {:.3g} are possible ({}): the results of another capture?", given,
                                found, model.cell.camera ? "px, median" : "of the noise, median"));
  }
}

}  // namespace poecal
