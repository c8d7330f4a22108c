#include "simulation/true_cell.hpp"

#include "poecal/effects/catalogue.hpp"

namespace poecal {

Cell trueCell(const Scene& scene) { return {.arm = scene.actual, .camera = scene.camera, .registration = scene.registration}; }

std::vector<Disturbance> trueDisturbances(const Scene& scene, const std::vector<Sample>& samples) {
  constexpr bool kWithDraws = true;
  return disturbancesOf(scene.effects, trueCell(scene), scene.target, Capture{}.gravity, samples, kWithDraws);
}

}  // namespace poecal
