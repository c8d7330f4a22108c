// The cell that a scene really is: what its effects do to each sample.
#pragma once

#include <vector>

#include "poecal/cell/ports.hpp"
#include "poecal/simulation/scene.hpp"

namespace poecal {

/// The scene's arm, lens and registration before any effect.
Cell trueCell(const Scene& scene);

/// What the scene's effects do, one entry per sample; points are those of scene.target.
/// @throws InsufficientData: the samples lack what an effect is driven by.
std::vector<Disturbance> trueDisturbances(const Scene& scene, const std::vector<Sample>& samples);

}  // namespace poecal
