// A folder of pictures of a board -> camera.yaml, for the command `intrinsics` and for captures that name such a folder.
#pragma once

#include <filesystem>

#include "poecal/camera/intrinsics.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// Finds the board of FOLDER/target.yaml in each picture of FOLDER, calibrates, and writes `camera_file` and residualsFile(camera_file).
/// Tags are fitted once more with the lens that was found, and the lens is found again from those: bent edges taken as straight ones put a
/// tag's corners off by more than the noise does.
/// @param jobs  pictures at a time; 0: one per core. @param listener  told of warnings; and of progress, of the fits where options.progress
/// is empty.
/// @throws FileError, InsufficientData as the readers, the detector and calibrateIntrinsics do.
IntrinsicsResult calibrateBoardFolder(const std::filesystem::path& folder, const IntrinsicsOptions& options, int jobs,
                                      const std::filesystem::path& camera_file, Listener& listener);

/// STEM-residuals.csv beside a camera file: every picture's residuals.
std::filesystem::path residualsFile(const std::filesystem::path& camera_file);

}  // namespace poecal
