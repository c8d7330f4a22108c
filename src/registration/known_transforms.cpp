#include "registration/known_transforms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "cell/transform_names.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/registration/implausible.hpp"

namespace poecal {
namespace {

// A loose arm that is still nominal misses by some times more where it may not shift; a transform in other units by thousands of times.
constexpr double kFarWorse = 10.0;
// Beyond what shifted axes of an arm cost: then a transform is off, by however little.
constexpr double kClearlyWorse = 3.0;
// Where it fits as well as this, nothing is contradicted.
constexpr double kWorse = 1.2;

Consensus fitted(const Cell& start, const Registration& closed_form, const std::vector<Observation>& observations,
                 const std::vector<HypothesisSample>& samples, bool robust) {
  Consensus found;
  found.fit = adjust(start, observations, registrationAdjustment(robust));
  found.closed_form = closed_form;
  found.misfit = medianMisfit(found.fit.cell.registration, samples, misfitIn(found.fit.cell, observations));
  return found;
}

/// The registration with the near (or far) transform put where most samples see it if the other one is as known.
Registration freed(const Registration& known, bool near, const std::vector<HypothesisSample>& samples, const Misfit& misfit) {
  constexpr std::size_t kTried = 20;
  Registration best = known;
  double least = std::numeric_limits<double>::infinity();
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / kTried);
  for (std::size_t k = 0; k < samples.size(); k += stride) {
    for (const Eigen::Isometry3d& T_camera_target : samples[k].candidates) {
      Registration one = known;
      if (near) {
        one.T_camera_near = T_camera_target * (samples[k].T_near_far * known.T_far_target).inverse();
      } else {
        one.T_far_target = (known.T_camera_near * samples[k].T_near_far).inverse() * T_camera_target;
      }
      const double median = medianMisfit(one, samples, misfit);
      if (!(median < least)) continue;
      least = median;
      best = one;
    }
  }
  return best;
}

/// What the poses say against the near (or far) transform, which they put where `seen` has it; empty where nothing.
/// @param slight  also by less than a nominal arm may be the cause of
std::string contradiction(const Registration& stated, bool near, const Registration& seen, bool slight = false) {
  // What the axes of a loose arm that is still nominal may turn and shift a registration by.
  constexpr double kAngle = 0.05, kDistance = 0.05, kSigmas = 5.0;  // [rad], [m]
  const std::optional<KnownTransform>& known = near ? stated.known_near : stated.known_far;
  if (!known) return "";
  const Eigen::Isometry3d& T = near ? seen.T_camera_near : seen.T_far_target;
  const Vector6d off = logSe3(T * known->T.inverse());
  const bool beyond = (off.cwiseAbs().array() > kSigmas * known->sigma.array()).any();
  const double angle = off.head<3>().norm(), distance = (T.translation() - known->T.translation()).norm();
  if (!beyond || (!slight && angle < kAngle && distance < kDistance)) return "";
  return fmt::format("{} is stated {:.0f} mm and {:.0f} mrad from where the poses put it: is it of this cell, and the right way round?",
                     near ? nearName(stated) : farName(stated), 1e3 * distance, 1e3 * angle);
}

}  // namespace

bool knowsBoth(const Registration& registration) {
  return registration.known_near && registration.known_far && registration.known_near->sigma.allFinite() &&
         registration.known_far->sigma.allFinite();
}

Consensus consensusAsKnown(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                           bool robust) {
  Cell start = cell;
  Registration& known = start.registration;
  known.T_camera_near = cell.registration.known_near->T;
  known.T_far_target = cell.registration.known_far->T;
  Consensus found = fitted(start, known, observations, samples, robust);
  const Misfit misfit = misfitIn(cell, observations);
  for (const bool near : {true, false}) {
    const Registration other = freed(known, near, samples, misfit);
    const std::string said = contradiction(known, near, other);
    if (said.empty() || found.misfit < kFarWorse * medianMisfit(other, samples, misfit)) continue;
    throw ImplausibleCapture(said, InputPart::kRegistration);
  }
  return found;
}

std::vector<std::string> weighInKnown(const Cell& known, const std::vector<Observation>& observations,
                                      const std::vector<HypothesisSample>& samples, bool robust, Consensus& found) {
  const Registration& stated = known.registration;
  if (!stated.known_near && !stated.known_far) return {};
  const auto contradictionsBy = [&stated](const Registration& seen, bool slight) {
    std::vector<std::string> all;
    for (const bool near : {true, false}) {
      std::string said = contradiction(stated, near, seen, slight);
      if (!said.empty()) all.push_back(std::move(said));
    }
    return all;
  };
  const Registration own = found.fit.cell.registration;
  std::vector<std::string> contradictions = contradictionsBy(own, false);
  Cell start = found.fit.cell;
  start.registration.known_near = stated.known_near;
  start.registration.known_far = stated.known_far;
  const double by_itself = found.misfit;
  found = fitted(start, found.closed_form, observations, samples, robust);
  if (contradictions.empty() && found.misfit > kClearlyWorse * by_itself) contradictions = contradictionsBy(own, true);
  if (!contradictions.empty() && !(found.misfit < kFarWorse * by_itself)) {
    throw ImplausibleCapture(contradictions.front(), InputPart::kRegistration);
  }
  // Poses that hardly turn put a transform anywhere, and leave it where it is stated to be.
  if (found.misfit < kWorse * by_itself) return contradictionsBy(found.fit.cell.registration, false);
  return contradictions;
}

}  // namespace poecal
