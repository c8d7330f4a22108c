#include "registration/target_size.hpp"

#include <algorithm>
#include <cmath>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

// Steps of the logarithm of the size: large against rounding, small against the curvature of the sum of squares.
constexpr double kStep = 0.01;
constexpr double kLongestStep = 0.1;
constexpr int kRounds = 12;

/// The registration at one size.
class Profile {
 public:
  Profile(const Problem& problem, const Registration& start) : problem_(problem), last_(start) {}

  double chiSquare(double log_size) {
    Problem scaled = problem_;
    scaleTarget(scaled, std::exp(log_size));
    Cell cell = scaled.cell;
    cell.registration = last_;
    AdjustmentOptions options = registrationAdjustment(false);
    options.scale = 1.0;
    options.max_iterations = 40;
    const Adjustment fit = adjust(cell, scaled.observations, options);
    last_ = fit.cell.registration;
    rms_ = cornerRms(fit.cell, scaled.observations);
    return fit.chi_square;
  }
  const Registration& registration() const { return last_; }
  double rms() const { return rms_; }

 private:
  const Problem& problem_;
  Registration last_;
  double rms_ = 0.0;
};

}  // namespace

std::optional<TargetSize> fitTargetSize(const Problem& problem, const Registration& start) {
  const Problem kept = agreeing(problem, start);
  const double spare = 6.0 * static_cast<double>(kept.observations.size()) - 13.0;
  if (spare < 11.0) return std::nullopt;
  Profile profile(kept, start);
  TargetSize size;
  profile.chiSquare(0.0);
  size.rms_as_stated = profile.rms();
  double log_size = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const double below = profile.chiSquare(log_size - kStep), at = profile.chiSquare(log_size), above = profile.chiSquare(log_size + kStep);
    const double slope = (above - below) / (2.0 * kStep), curvature = (above - 2.0 * at + below) / (kStep * kStep);
    if (!std::isfinite(curvature)) return std::nullopt;
    double step = curvature > 0.0 ? -slope / curvature : (slope > 0.0 ? -kLongestStep : kLongestStep);
    step = std::clamp(step, -kLongestStep, kLongestStep);
    log_size += step;
    if (curvature > 0.0) size.deviation = std::sqrt(2.0 * at / spare / curvature);
    if (curvature > 0.0 && std::abs(step) < std::max(1e-6, 0.01 * size.deviation)) {
      profile.chiSquare(log_size);
      size.rms = profile.rms();
      size.registration = profile.registration();
      size.factor = std::exp(log_size);
      size.deviation *= size.factor;
      return size;
    }
  }
  return std::nullopt;
}

}  // namespace poecal
