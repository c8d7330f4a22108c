#include "calibration/identified_folder.hpp"

#include <cmath>

#include <fmt/format.h>

#include "poecal/calibration/model_of_capture.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

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
  requireModelOf({measurements.setup, &*here.arm, here.camera ? &*here.camera : nullptr, &measurements.target}, model, file);
  if (here.camera && !model.cell.camera) throw FileError(file, 1, "has no camera, expected a model from pictures as those of the capture");
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
