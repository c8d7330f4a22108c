// A scene -> a capture folder, with its truth beside it.
#pragma once

#include <filesystem>
#include <vector>

#include "poecal/simulation/scene.hpp"

namespace poecal {

struct SimulateOptions {
  int jobs = 0;
};

/// Joint readings of a scene: read from its file, or drawn uniformly within the limits (revolute joints without limits: +-pi; limits are
/// cut to +-pi about their middle) and kept where the whole target is in the picture with a margin of 5 % of its size, before the camera, faces it
/// within 60 degrees (at least one tag of a target with several faces does), and where a tag's side is at least 40 px.
/// Rows carry q1..qn, pose, stamp (10 s apart), dir1..dirn (side from which each joint came from the pose before).
/// @throws InsufficientData where 1000 draws per pose find none in view, with what to change.
SampleTable drawSamples(const Scene& scene);

/// Exact corners of a scene, one entry per sample, of tags that face the camera and are in the picture whole.
std::vector<ImageCorners> trueCorners(const Scene& scene, const SampleTable& samples);

/// Writes the capture folder `capture` and the folder `capture`-truth beside it: truth.yaml (registration, the scene's seeds and noise),
/// actual.yaml (the arm), camera.yaml, target.yaml, corners.csv (exact), samples.csv (the joints that the arm really had). Deterministic by the scene's seeds,
/// whatever options.jobs. @throws FileError if `capture` exists and is not empty.
void simulate(const Scene& scene, const std::filesystem::path& capture, const SimulateOptions& options);

}  // namespace poecal
