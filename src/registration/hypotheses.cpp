#include "registration/hypotheses.hpp"

#include <algorithm>
#include <limits>

#include "poecal/core/random.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/registration/hand_eye.hpp"

namespace poecal {
namespace {

// Four poses: a general arm needs three, and a SCARA, whose turns share one direction, has then two equations to spare.
constexpr std::size_t kMinimalSet = 4;
constexpr std::size_t kKept = 5;
// Scoring all of ten thousand pictures for every hypothesis would buy nothing.
constexpr std::size_t kScored = 150;
// Nearly half of the samples may be wrong.
constexpr double kAgreeing = 0.5;
// A turn [rad] or a way [m] that tells two poses apart.
constexpr double kSamePose = 1e-6;

std::optional<Registration> registrationOf(Setup setup, const std::vector<Eigen::Isometry3d>& near_far,
                                           const std::vector<Eigen::Isometry3d>& targets) {
  const std::optional<HandEye> solution = solveHandEye(near_far, targets, setup);
  if (!solution) return std::nullopt;
  Registration registration;
  registration.setup = setup;
  registration.T_camera_near = solution->T_camera_near;
  registration.T_far_target = solution->T_far_target;
  return registration;
}

double scoreOf(const Registration& registration, const std::vector<HypothesisSample>& samples, const Misfit& misfit) {
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / kScored);
  std::vector<double> misfits;
  for (std::size_t k = 0; k < samples.size(); k += stride) misfits.push_back(misfit(registration, samples[k]));
  const auto place = static_cast<std::ptrdiff_t>(kAgreeing * static_cast<double>(misfits.size() - 1));
  std::nth_element(misfits.begin(), misfits.begin() + place, misfits.end());
  return misfits[static_cast<std::size_t>(place)];
}

/// Closed form over all samples that agree with a registration, each with the candidate that agrees best.
std::optional<Registration> refit(const Hypothesis& hypothesis, const std::vector<HypothesisSample>& samples, const Misfit& misfit) {
  std::vector<Eigen::Isometry3d> near_far, targets;
  for (const HypothesisSample& sample : samples) {
    if (sample.candidates.empty() || !(misfit(hypothesis.registration, sample) <= 2.0 * hypothesis.score)) continue;
    const Eigen::Isometry3d predicted = hypothesis.registration.T_camera_near * sample.T_near_far * hypothesis.registration.T_far_target;
    const auto nearest = std::min_element(sample.candidates.begin(), sample.candidates.end(), [&](const auto& a, const auto& b) {
      return rotationAngle(predicted.linear().transpose() * a.linear()) < rotationAngle(predicted.linear().transpose() * b.linear());
    });
    near_far.push_back(sample.T_near_far);
    targets.push_back(*nearest);
  }
  if (near_far.size() < kMinimalSet) return std::nullopt;
  return registrationOf(hypothesis.registration.setup, near_far, targets);
}

/// Draws samples of different poses to the front of `usable`; false where there are not enough of them among a few dozen draws.
bool drawDifferent(Rng& rng, std::size_t count, const std::vector<HypothesisSample>& samples, std::vector<std::size_t>& usable) {
  int attempts = 40;
  for (std::size_t k = 0; k < count; ++k) {
    bool repeated = true;
    while (repeated && attempts-- > 0) {
      std::swap(usable[k], usable[k + rng.below(usable.size() - k)]);
      const Eigen::Isometry3d& drawn = samples[usable[k]].T_near_far;
      repeated = std::any_of(usable.begin(), usable.begin() + static_cast<std::ptrdiff_t>(k),
                             [&](std::size_t earlier) { return samePose(samples[earlier].T_near_far, drawn); });
    }
    if (repeated) return k >= 3;
  }
  return true;
}

}  // namespace

bool samePose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm() <= kSamePose && (a.linear() - b.linear()).norm() <= kSamePose;
}

std::size_t differentPoses(const std::vector<HypothesisSample>& samples, std::size_t enough) {
  std::vector<const Eigen::Isometry3d*> different;
  for (const HypothesisSample& sample : samples) {
    if (sample.candidates.empty()) continue;
    const bool known = std::any_of(different.begin(), different.end(), [&](const auto* T) { return samePose(*T, sample.T_near_far); });
    if (!known) different.push_back(&sample.T_near_far);
    if (different.size() == enough) break;
  }
  return different.size();
}

std::vector<Hypothesis> searchRegistrations(Setup setup, const std::vector<HypothesisSample>& samples, const Misfit& misfit,
                                            int hypotheses) {
  std::vector<std::size_t> usable;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (!samples[k].candidates.empty()) usable.push_back(k);
  }
  std::vector<Hypothesis> found;
  const std::size_t set_size = differentPoses(samples, kMinimalSet);
  if (set_size < 3) return found;
  Rng rng(20130156);
  for (int trial = 0; trial < hypotheses; ++trial) {
    if (!drawDifferent(rng, set_size, samples, usable)) continue;
    std::vector<Eigen::Isometry3d> near_far, targets;
    for (std::size_t k = 0; k < set_size; ++k) {
      const HypothesisSample& sample = samples[usable[k]];
      near_far.push_back(sample.T_near_far);
      // Where many rows are wrong, few sets are right at all; every other one does not add doubt of the pictures to that.
      targets.push_back(sample.candidates[trial % 2 == 0 ? 0 : rng.below(sample.candidates.size())]);
    }
    const std::optional<Registration> registration = registrationOf(setup, near_far, targets);
    if (registration) found.push_back({*registration, scoreOf(*registration, samples, misfit)});
  }
  const auto better = [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; };
  std::stable_sort(found.begin(), found.end(), better);
  if (found.size() > kKept) found.resize(kKept);
  for (Hypothesis& hypothesis : found) {
    for (int round = 0; round < 3; ++round) {
      const std::optional<Registration> registration = refit(hypothesis, samples, misfit);
      if (!registration) break;
      const double score = scoreOf(*registration, samples, misfit);
      if (!(score < hypothesis.score)) break;
      hypothesis = {*registration, score};
    }
  }
  std::stable_sort(found.begin(), found.end(), better);
  return found;
}

}  // namespace poecal
