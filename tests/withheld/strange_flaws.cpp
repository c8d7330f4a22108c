#include "withheld/strange_flaws.hpp"

#include <cmath>

#include <fmt/format.h>

namespace withheld {
namespace {

using Act = std::function<void(const Flaw&, const Shot&, const Loads&, State&)>;

/// An error of one joint of the size value[0] and of any shape in [-1, 1].
Flaw jointFlaw(const std::string& effect, std::size_t k, const std::string& driver, std::function<double(const Shot&, const Loads&)> shape,
               bool yields) {
  const auto K = static_cast<Eigen::Index>(k);
  return {effect,
          fmt::format("joint:{}", k + 1),
          driver,
          {{"size", 5e-4, 5e-4, 2e-2}},
          [K, shape](const Flaw& f, const Shot& s, const Loads& loads, State& c) { c.q[K] += f[0] * shape(s, loads); },
          yields};
}

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

/// Joints whose torque changes enough over the shots to drive anything.
std::vector<std::size_t> loadedJoints(const Cell& cell, const std::vector<Shot>& shots) {
  constexpr double kLeast = 1.0;  // standard deviation [N m]
  std::vector<std::size_t> loaded;
  for (std::size_t k = 0; k < cell.arm.size(); ++k) {
    double sum = 0.0, squares = 0.0;
    for (const Shot& shot : shots) {
      const double torque = gravityLoads(cell, flawless(cell, shot), shot.payload).torque[static_cast<Eigen::Index>(k)];
      sum += torque;
      squares += torque * torque;
    }
    const auto count = static_cast<double>(shots.size());
    if (squares / count - std::pow(sum / count, 2) > kLeast * kLeast) loaded.push_back(k);
  }
  return loaded;
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
  const Vector turn = 3e-4 * randomDirection(chance), shift = 3e-4 * randomDirection(chance);
  const double cycles = chance.between(1.6, 3.5), phase = chance.between(0.0, 6.28);
  const double first = shots.front().stamp, span = shots.back().stamp - first;
  return {"camera sway", "camera.mount", "stamp", {{"size", 1.0, 1.0, 30.0}}, [=](const Flaw& f, const Shot& s, const Loads&, State& c) {
            const double wave = f[0] * std::sin(6.283 * cycles * (s.stamp - first) / span + phase);
            c.camera = motion(wave * turn, wave * shift) * c.camera;
          }};
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

Flaw strangeFlaw(const Cell& cell, const std::vector<Shot>& shots, Chance& chance) {
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
