#include "registration/lens_and_size.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "poecal/core/statistics.hpp"
#include "poecal/registration/implausible.hpp"
#include "registration/plausibility.hpp"
#include "registration/target_size.hpp"

namespace poecal {
namespace {

constexpr std::size_t kRows = 80;
constexpr double kBeyondChance = 1e-6;
constexpr double kClearlyLower = 0.8;
// A ruler's error is below it; a margin or another tag is above.
constexpr double kOtherTarget = 0.1;

struct LensFit {
  Camera camera;
  double rms = 0.0, rms_as_stated = 0.0;
  double chance = 1.0;  ///< of such a gain
};

/// Wide enough for pictures of another resolution, narrow enough to keep distortion from absurd values.
Eigen::VectorXd wideLens(const Camera& camera) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(camera.parameterCount(), 0.5);
  sigma.head<4>().setConstant(0.5 * camera.fx);
  return sigma;
}

LensFit fitLens(const Cell& registered, const Problem& few) {
  AdjustmentOptions options = registrationAdjustment(false);
  options.scale = 1.0;
  options.max_iterations = 60;
  const Adjustment held = adjust(registered, few.observations, options);
  options.free.intrinsics = true;
  options.camera_prior_sigma = wideLens(*registered.camera);
  const Adjustment freed = adjust(held.cell, few.observations, options);
  LensFit lens{*freed.cell.camera, cornerRms(freed.cell, few.observations), cornerRms(held.cell, few.observations)};
  const double unknowns = registered.camera->parameterCount();
  const double spare = 6.0 * static_cast<double>(few.observations.size()) - 12.0 - unknowns;
  if (spare > unknowns && freed.chi_square > 0.0) {
    lens.chance = fTail(std::max(0.0, held.chi_square - freed.chi_square) / unknowns / (freed.chi_square / spare), unknowns, spare);
  }
  return lens;
}

/// "fx 900.2 instead of 1035": the figures in pixels, those that moved by more than a percent of the focal length.
std::string describeMove(const Camera& stated, const Camera& fitted) {
  const std::vector<std::string> names = stated.parameterNames();
  std::string text;
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double from = stated.parameters()(k), to = fitted.parameters()(k);
    if (k > 0 && std::abs(to - from) < 0.01 * stated.fx) continue;
    text += fmt::format("{}{} {:.5g} instead of {:.5g}", text.empty() ? "" : ", ", names[static_cast<std::size_t>(k)], to, from);
  }
  return text;
}

}  // namespace

std::vector<std::string> checkLensAndSize(const Cell& registered, const std::vector<Observation>& observations,
                                          const std::vector<HypothesisSample>& samples) {
  const Problem few = agreeing(thinned(registered, observations, samples, kRows), registered.registration);
  if (few.observations.size() < 6) return {};
  const double floor = freeMisfit(few.samples);
  const std::optional<TargetSize> size = fitTargetSize(few, registered.registration);
  const LensFit lens = fitLens(registered, few);
  const bool other_lens = lens.chance < kBeyondChance && lens.rms < kClearlyLower * lens.rms_as_stated;
  const bool other_size = size && std::abs(size->factor - 1.0) > 6.0 * size->deviation && size->rms < kClearlyLower * size->rms_as_stated;
  // A wrong lens takes part of its error to the size and the other way round: whichever leaves clearly less is it.
  if (other_size && !(other_lens && lens.rms < 0.7 * size->rms)) {
    const std::string text = sizeText(size->factor, size->deviation);
    if (std::abs(size->factor - 1.0) > kOtherTarget) {
      throw ImplausibleCapture(
          text + fmt::format(" (at that size the pictures fit to {:.3g} instead of {:.3g} px)", size->rms, size->rms_as_stated),
          InputPart::kTarget);
    }
    return {text + fmt::format(": at that size the pictures fit to {:.3g} instead of {:.3g} px", size->rms, size->rms_as_stated)};
  }
  if (!other_lens) return {};
  return {fmt::format(
      "the stated lens does not fit these pictures (another resolution, or cut out?): with it re-fitted ({}) they fit to {:.3g} "
      "instead of {:.3g} px; with a pose of their own, {:.3g} px at the stated lens",
      describeMove(*registered.camera, lens.camera), lens.rms, lens.rms_as_stated, floor)};
}

}  // namespace poecal
