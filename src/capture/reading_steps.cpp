#include "capture/reading_steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "poecal/robot/arm.hpp"

namespace poecal {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// Of a step: by chance a reading is as near to a multiple once in fifty times, and eight of them once in 1e12.
constexpr double kNear = 0.01;
constexpr std::size_t kFewest = 8;
// [rad], [m]: what makers state of repeatability. Twice it is clearly coarser.
constexpr double kRepeats = 5e-5, kClearly = 2.0;

/// Finer steps are below what any encoder tells.
constexpr int kFinest = -6;

std::vector<ReadingStep> possibleSteps(JointType type) {
  std::vector<ReadingStep> steps;
  for (int power = 0; power >= kFinest; --power) {
    for (const double digit : {5.0, 2.0, 1.0}) {
      const double size = digit * std::pow(10.0, power);
      if (type == JointType::kPrismatic) {
        steps.push_back({size, fmt::format("{:.6g} mm", 1e3 * size)});
        continue;
      }
      steps.push_back({size, fmt::format("{:.6g} rad", size)});
      steps.push_back({10.0 * size * std::numbers::pi / 180.0, fmt::format("{:.6g} degree{}", 10.0 * size, 10.0 * size > 1.0 ? "s" : "")});
    }
  }
  for (int bits = 6; type == JointType::kRevolute && bits <= 20; ++bits) {
    const double parts = std::pow(2.0, bits);
    steps.push_back({kTurn / parts, fmt::format("1/{:.0f} of a turn", parts)});
  }
  std::stable_sort(steps.begin(), steps.end(), [](const ReadingStep& a, const ReadingStep& b) { return a.size > b.size; });
  return steps;
}

bool areMultiples(const std::vector<double>& readings, double step) {
  return std::all_of(readings.begin(), readings.end(), [&](double reading) {
    const double multiple = (reading - readings.front()) / step;
    return std::abs(multiple - std::round(multiple)) <= kNear;
  });
}

/// "q1, q3 to q6": ascending, from 0.
std::string listOf(const std::vector<std::size_t>& joints) {
  std::string text;
  for (std::size_t k = 0; k < joints.size();) {
    std::size_t last = k;
    while (last + 1 < joints.size() && joints[last + 1] == joints[last] + 1) ++last;
    text += fmt::format("{}q{}", text.empty() ? "" : ", ", joints[k] + 1);
    if (last > k) text += fmt::format("{}q{}", last == k + 1 ? ", " : " to ", joints[last] + 1);
    k = last + 1;
  }
  return text;
}

}  // namespace

std::optional<ReadingStep> readingStep(JointType type, std::vector<double> readings) {
  std::sort(readings.begin(), readings.end());
  readings.erase(std::unique(readings.begin(), readings.end()), readings.end());
  if (readings.size() < kFewest) return std::nullopt;
  for (ReadingStep& step : possibleSteps(type)) {
    if (areMultiples(readings, step.size)) return std::move(step);
  }
  return std::nullopt;
}

bool Rounding::isCoarse() const {
  return std::any_of(steps.begin(), steps.end(),
                     [](const auto& step) { return step && step->size > kClearly * std::sqrt(12.0) * kRepeats; });
}

Eigen::VectorXd Rounding::sigmas() const {
  return Eigen::VectorXd::NullaryExpr(static_cast<Eigen::Index>(steps.size()), [this](Eigen::Index k) {
    const auto& step = steps[static_cast<std::size_t>(k)];
    return step ? step->size / std::sqrt(12.0) : 0.0;
  });
}

std::string Rounding::text() const {
  double coarsest = 0.0;
  for (const auto& step : steps) coarsest = std::max(coarsest, step ? step->size : 0.0);
  std::vector<std::size_t> joints;
  std::string of;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!steps[k] || steps[k]->size < coarsest) continue;
    joints.push_back(k);
    of = steps[k]->text;
  }
  return fmt::format("{} {} multiples of {}: rounded so, the flange is off by up to {:.2g} mm ({:.2g} mm rms)", listOf(joints),
                     joints.size() == 1 ? "holds" : "hold", of, 1e3 * largest, 1e3 * rms);
}

Rounding roundingOf(const Arm& arm, const std::vector<Sample>& samples) {
  Rounding rounding;
  rounding.steps.resize(arm.joints.size());
  if (samples.empty()) return rounding;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    std::vector<double> readings;
    for (const Sample& sample : samples) readings.push_back(sample.q(static_cast<Eigen::Index>(k)));
    rounding.steps[k] = readingStep(arm.joints[k].type, std::move(readings));
  }
  double squares = 0.0;
  for (const Sample& sample : samples) {
    const ArmChain chain = forwardChain(arm, sample.q);
    const Matrix6Xd J = spaceJacobian(arm, chain);
    double sum = 0.0;
    for (std::size_t k = 0; k < rounding.steps.size(); ++k) {
      if (!rounding.steps[k]) continue;
      const Vector6d twist = J.col(static_cast<Eigen::Index>(k));
      const double way = (twist.head<3>().cross(chain.T_base_flange.translation()) + twist.tail<3>()).norm() * rounding.steps[k]->size;
      sum += 0.5 * way;
      squares += way * way / 12.0;
    }
    rounding.largest = std::max(rounding.largest, sum);
  }
  rounding.rms = std::sqrt(squares / static_cast<double>(samples.size()));
  return rounding;
}

}  // namespace poecal
