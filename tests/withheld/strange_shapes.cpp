#include "withheld/strange_shapes.hpp"

#include <cmath>

#include <fmt/format.h>

namespace withheld {

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

std::vector<std::size_t> turningJoints(const Cell& cell) {
  std::vector<std::size_t> turning;
  for (std::size_t k = 0; k < cell.arm.size(); ++k) {
    if (!cell.arm.joints[k].slides) turning.push_back(k);
  }
  return turning;
}

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

Flaw mountFlaw(const std::string& effect, bool camera, const std::vector<Shot>& shots, std::function<double(double)> wave, Chance& chance) {
  const Vector turn = 3e-4 * randomDirection(chance), shift = 3e-4 * randomDirection(chance);
  const double first = shots.front().stamp, span = shots.back().stamp - first;
  return {effect,
          camera ? "camera.mount" : "target.mount",
          "stamp",
          {{"size", 1.0, 1.0, 30.0}},
          [=](const Flaw& f, const Shot& s, const Loads&, State& c) {
            const double size = f[0] * wave((s.stamp - first) / span);
            Frame& mount = camera ? c.camera : c.grip;
            mount = motion(size * turn, size * shift) * mount;
          }};
}

}  // namespace withheld
