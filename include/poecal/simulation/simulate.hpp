// A scene -> a capture folder, with its truth beside it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "poecal/core/progress.hpp"
#include "poecal/simulation/scene.hpp"

namespace poecal {

struct SimulateOptions {
  int jobs = 0;                    ///< pictures drawn at a time; 0: one per core
  ProgressFunction progress = {};  ///< told of each pose and each picture; may be empty
};

/// Joint readings of a scene: read from its file, or drawn uniformly within the limits (revolute joints without limits: +-pi; limits are
/// cut to +-pi about their middle) and kept where the whole target is before the camera and in the picture, 5 % of the picture's width and
/// height away from its borders, and where it faces the camera within 60 degrees with tags' sides of at least 40 px (a board's squares: 15
/// px); of several tags one must. Rows carry q1..qn, pose, stamp (10 s apart), dir1..dirn (side from which each joint came from the pose
/// before); and, where an effect is driven by them, dq1..dqn or temperature.
/// @throws InsufficientData where 1000 draws for a pose find none in view, with what to change. FileError: a prismatic joint without
/// limits.
/// @param options  their progress is told of each pose that is drawn.
SampleTable drawSamples(const Scene& scene, const SimulateOptions& options = {});

/// Exact corners of a scene, one entry per sample, of tags (or the board) that face the camera within 80 degrees and are in the picture
/// whole, with the scene's effects. Tags that other tags hide are not left out.
std::vector<ImageCorners> trueCorners(const Scene& scene, const SampleTable& samples);

/// What was written.
struct SimulateSummary {
  std::size_t poses = 0;
  std::size_t samples = 0;         ///< rows of samples.csv
  std::size_t without_target = 0;  ///< samples that show no tag whole; only samples from a file do
  std::size_t corners = 0;         ///< of all samples
  bool pictures = false;           ///< pictures; otherwise detections.csv
  std::size_t boards = 0;          ///< intrinsics pictures
  std::filesystem::path truth;     ///< the truth's folder
};

/// Writes the capture folder `capture` and the folder `capture`-truth beside it: truth.yaml (registration, the scene's seeds and noise),
/// actual.yaml (the arm), camera.yaml, target.yaml, corners.csv (exact), samples.csv (the joints that the arm really had) and, where the
/// pictures are to look like others, pictures.csv (the blur and noise of each). Deterministic by the scene's seeds, whatever options.jobs.
/// With intrinsics pictures the truth also holds their exact corners, intrinsics_corners.csv.
/// capture.yaml is written last. A folder that a killed program began with the same scene is finished: pictures that are there are not
/// drawn again. While it is being written the file `.unfinished` is in it.
/// @throws FileError if one of the two folders exists, is not empty and is no such folder; InsufficientData where the samples lack what an
/// effect is driven by.
SimulateSummary simulate(const Scene& scene, const std::filesystem::path& capture, const SimulateOptions& options);

}  // namespace poecal
