// The second family: stairs, random curves, folded waves, friction that saturates, jumps in time, a swirl in the lens.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "withheld/strange_flaws.hpp"
#include "withheld/strange_shapes.hpp"

namespace withheld {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Stairs of random heights at random places of [0, 1], within [-1, 1].
std::function<double(double)> stairs(int steps, Chance& chance) {
  std::vector<double> at, height;
  for (int i = 0; i < steps; ++i) {
    at.push_back((i + chance.between(0.2, 0.8)) / steps);
    height.push_back(chance.between(-1.0, 1.0));
  }
  return [=](double x) {
    double value = 0.0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (x >= at[i]) value = height[i];
    }
    return value;
  };
}

/// A polygon through random heights at even places of [0, 1].
std::function<double(double)> polygon(int corners, Chance& chance) {
  std::vector<double> height;
  for (int i = 0; i <= corners; ++i) height.push_back(chance.between(-1.0, 1.0));
  return [=](double x) {
    const double place = std::clamp(x, 0.0, 1.0 - 1e-9) * corners;
    const auto i = static_cast<std::size_t>(place);
    return height[i] + (place - static_cast<double>(i)) * (height[i + 1] - height[i]);
  };
}

Flaw curveOfAngle(const Cell& cell, Chance& chance) {
  const std::size_t k = chance.index(cell.arm.size());
  const auto K = static_cast<Eigen::Index>(k);
  const Joint& joint = cell.arm.joints[k];
  const double low = joint.low, range = joint.high - joint.low;
  const std::string driver = fmt::format("q{}", k + 1);
  const bool stepped = chance.happens(0.5);
  const std::function<double(double)> shape = stepped ? stairs(4, chance) : polygon(7, chance);
  return jointFlaw(
      stepped ? "stairs in an angle" : "polygon in an angle", k, driver,
      [=](const Shot& s, const Loads&) { return shape((s.q[K] - low) / range); }, false);
}

Flaw curveOfTorque(const std::vector<std::size_t>& loaded, Chance& chance) {
  const std::size_t k = chance.oneOf(loaded);
  const auto K = static_cast<Eigen::Index>(k);
  const std::string driver = fmt::format("tau{}", k + 1);
  if (chance.happens(0.5)) {
    return jointFlaw(
        "gap under load", k, driver, [K](const Shot&, const Loads& loads) { return std::tanh(loads.torque[K] / 2.0); }, true);
  }
  return jointFlaw(
      "seal that gives", k, driver,
      [K](const Shot&, const Loads& loads) {
        const double tau = loads.torque[K];
        return std::copysign(std::max(0.0, std::abs(tau) - 8.0), tau) / 20.0;
      },
      true);
}

Flaw curveOfTime(const Cell& cell, const std::vector<Shot>& shots, Chance& chance) {
  const std::function<double(double)> shape = chance.happens(0.5) ? stairs(5, chance) : polygon(6, chance);
  if (chance.happens(0.6)) return mountFlaw("mount jumps or wanders", chance.happens(0.5), shots, shape, chance);
  const std::size_t k = 1 + chance.index(cell.arm.size() - 2);  // the first and last ones are a camera's and a target's motion too
  const double first = shots.front().stamp, span = shots.back().stamp - first;
  return jointFlaw(
      "joint jumps or wanders", k, "stamp", [=](const Shot& s, const Loads&) { return shape((s.stamp - first) / span); }, false);
}

Flaw swirledLens(const Cell& cell, Chance& chance) {
  const Eigen::Vector2d center(cell.lens.width * chance.between(0.3, 0.7), cell.lens.height * chance.between(0.3, 0.7));
  const double radius = chance.between(300.0, 500.0);
  return {"swirl in the lens", "camera.lens", "pixel", {{"size", 0.5, 0.5, 10.0}}, [=](const Flaw& f, const Shot&, const Loads&, State& c) {
            const double size = f[0];
            c.warp = [=](const Eigen::Vector2d& px) -> Eigen::Vector2d {
              const Eigen::Vector2d arm = (px - center) / radius;
              return px + size * std::exp(0.5 - 0.5 * arm.squaredNorm()) * Eigen::Vector2d(-arm.y(), arm.x());
            };
          }};
}

}  // namespace

Flaw secondStrangeFlaw(const Cell& cell, const std::vector<Shot>& shots, Chance& chance) {
  switch (chance.index(8)) {
    case 0:
    case 1:
    case 2:
      return curveOfAngle(cell, chance);
    case 3:
    case 4:
      if (const std::vector<std::size_t> loaded = loadedJoints(cell, shots); !loaded.empty()) return curveOfTorque(loaded, chance);
      return curveOfAngle(cell, chance);
    case 5:
    case 6:
      return curveOfTime(cell, shots, chance);
    default:
      return swirledLens(cell, chance);
  }
}

Flaw fastFlaw(const Cell& cell, const std::vector<Shot>& shots, Family family, Chance& chance) {
  const bool second = family == Family::second;
  if (chance.happens(0.4)) {
    const double cycles = chance.between(4.0, 8.0), phase = chance.between(0.0, kTurn);
    const auto wave = [=](double share) {
      const double x = kTurn * cycles * share + phase;
      return second ? 2.0 / KDL::PI * std::asin(std::sin(x)) : std::sin(x);
    };
    return mountFlaw(second ? "folded sway" : "sway", chance.happens(0.5), shots, wave, chance);
  }
  const std::size_t k = chance.oneOf(turningJoints(cell));
  const auto K = static_cast<Eigen::Index>(k);
  const Joint& joint = cell.arm.joints[k];
  const double low = joint.low, range = joint.high - joint.low;
  const std::string driver = fmt::format("q{}", k + 1);
  if (chance.happens(0.5)) {
    // As fine as 80 poses can show it: some ten poses in each tooth, or eight on each step.
    const double period = range / chance.between(5.0, 9.0);
    const double rise = second ? 0.75 : 1.0;  // of a tooth that rises; the rest falls
    return jointFlaw(
        "saw in an angle", k, driver,
        [=](const Shot& s, const Loads&) {
          const double x = (s.q[K] - low) / period, part = x - std::floor(x);
          return part < rise ? 2.0 * part / rise - 1.0 : 1.0 - 2.0 * (part - rise) / (1.0 - rise);
        },
        false);
  }
  const int steps = second ? 6 : 3;
  const std::function<double(double)> shape = stairs(steps, chance);
  return jointFlaw(
      "steps in an angle", k, driver, [=](const Shot& s, const Loads&) { return shape((s.q[K] - low) / range); }, false);
}

}  // namespace withheld
