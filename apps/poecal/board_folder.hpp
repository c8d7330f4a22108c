// A folder of board pictures -> intrinsics, for the command `intrinsics` and for captures that name such a folder.
#pragma once

#include <filesystem>

#include "command.hpp"
#include "poecal/camera/intrinsics.hpp"

namespace poecal::app {

struct BoardFolderResult {
  IntrinsicsResult intrinsics;
  int pictures = 0;  ///< in the folder
};

/// Finds the board of FOLDER/target.yaml in each picture of FOLDER and calibrates; notes and warnings go to stderr.
/// @throws FileError, InsufficientData as the readers, the detector and calibrateIntrinsics do.
BoardFolderResult calibrateBoardFolder(const std::filesystem::path& folder, const IntrinsicsOptions& options, const Common& common);

/// Writes camera.yaml and, beside it, the residuals of each picture (STEM-residuals.csv).
void writeBoardFolderResult(const BoardFolderResult& result, const std::filesystem::path& camera_file);

}  // namespace poecal::app
