#include "withheld/strange_flaws.hpp"

#include <cmath>

#include <fmt/format.h>

#include "withheld/strange_shapes.hpp"

namespace withheld {
namespace {

/// Odd in the joint's own angle: a dent, a saw, a stop that it leans on, a tooth that it skips.
Flaw oddAngle(const Cell& cell, Chance& chance) {
  const std::size_t k = chance.index(cell.arm.size());
  const auto K = static_cast<Eigen::Index>(k);
  const Joint& joint = cell.arm.joints[k];
  const double range = joint.high - joint.low;
  const double center = joint.low + range * chance.between(0.3, 0.7);
  const std::string driver = fmt::format("q{}", k + 1);
  const double width = range * chance.between(0.04, 0.1);
  const double period = range * chance.between(0.36, 0.44);
  switch (chance.index(4)) {
    case 0:
      return jointFlaw(
          "dent in an angle", k, driver, [=](const Shot& s, const Loads&) { return std::exp(-std::pow((s.q[K] - center) / width, 2)); },
          false);
    case 1:
      return jointFlaw(
          "saw in an angle", k, driver, [=](const Shot& s, const Loads&) { return 2.0 * std::remainder(s.q[K] - center, period) / period; },
          false);
    case 2:
      return jointFlaw(
          "hinge in an angle", k, driver, [=](const Shot& s, const Loads&) { return std::max(0.0, s.q[K] - center) / range; }, false);
    default:
      return jointFlaw(
          "skip in an angle", k, driver, [=](const Shot& s, const Loads&) { return s.q[K] > center ? 1.0 : 0.0; }, false);
  }
}

Flaw oddTorque(const std::vector<std::size_t>& loaded, Chance& chance) {
  const std::size_t k = chance.oneOf(loaded);
  const auto K = static_cast<Eigen::Index>(k);
  const std::string driver = fmt::format("tau{}", k + 1);
  if (chance.happens(0.5)) {
    return jointFlaw(
        "progressive spring", k, driver,
        [K](const Shot&, const Loads& loads) { return loads.torque[K] * std::abs(loads.torque[K]) / 400.0; }, true);
  }
  return jointFlaw(
      "gravity-sided gap", k, driver, [K](const Shot&, const Loads& loads) { return loads.torque[K] > 0.0 ? 1.0 : -1.0; }, true);
}

Flaw wavyJoint(const Cell& cell, const std::vector<Shot>& shots, Chance& chance) {
  const std::size_t k = 1 + chance.index(cell.arm.size() - 2);  // the first and last ones are a camera's and a target's motion too
  const double cycles = chance.between(1.6, 3.5), phase = chance.between(0.0, 6.28);
  const double first = shots.front().stamp, span = shots.back().stamp - first;
  return jointFlaw(
      "wave in time", k, "stamp", [=](const Shot& s, const Loads&) { return std::sin(6.283 * cycles * (s.stamp - first) / span + phase); },
      false);
}

Flaw sway(const std::vector<Shot>& shots, Chance& chance) {
  const double cycles = chance.between(1.6, 3.5), phase = chance.between(0.0, 6.28);
  return mountFlaw(
      "camera sway", true, shots, [=](double share) { return std::sin(6.283 * cycles * share + phase); }, chance);
}

Flaw creep(const std::vector<Shot>& shots, Chance& chance) {
  const Vector turn = 5e-4 * randomDirection(chance), shift = 5e-4 * randomDirection(chance);
  const double first = shots.front().stamp, span = shots.back().stamp - first;
  const double fade = span * chance.between(0.3, 0.8);
  return {"creep of the target",
          "target.mount",
          "stamp",
          {{"size", 1.0, 1.0, 30.0}},
          [=](const Flaw& f, const Shot& s, const Loads&, State& c) {
            const double gone = f[0] * std::exp(-(s.stamp - first) / fade);
            c.grip = motion(gone * turn, gone * shift) * c.grip;
          }};
}

Flaw dentedLens(const Cell& cell, Chance& chance) {
  const Eigen::Vector2d center(cell.lens.width * chance.between(0.3, 0.7), cell.lens.height * chance.between(0.3, 0.7));
  const double radius = chance.between(200.0, 400.0), heading = chance.between(0.0, 6.28);
  const Eigen::Vector2d push(std::cos(heading), std::sin(heading));
  return {"dent in the lens", "camera.lens", "pixel", {{"size", 0.5, 0.5, 10.0}}, [=](const Flaw& f, const Shot&, const Loads&, State& c) {
            const double size = f[0];
            c.warp = [=](const Eigen::Vector2d& px) -> Eigen::Vector2d {
              return px + push * (size * std::exp(-(px - center).squaredNorm() / (2.0 * radius * radius)));
            };
          }};
}

}  // namespace

Flaw strangeFlaw(const Cell& cell, const std::vector<Shot>& shots, Family family, Chance& chance) {
  if (family == Family::second) return secondStrangeFlaw(cell, shots, chance);
  switch (chance.index(8)) {
    case 0:
    case 1:
      return oddAngle(cell, chance);
    case 2:
    case 3:
      if (const std::vector<std::size_t> loaded = loadedJoints(cell, shots); !loaded.empty()) return oddTorque(loaded, chance);
      return oddAngle(cell, chance);
    case 4:
      return wavyJoint(cell, shots, chance);
    case 5:
      return sway(shots, chance);
    case 6:
      return creep(shots, chance);
    default:
      return dentedLens(cell, chance);
  }
}

}  // namespace withheld
