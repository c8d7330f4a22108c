// A folder of pictures of a board -> the points that intrinsics are found from.
#pragma once

#include <filesystem>
#include <vector>

#include "poecal/camera/intrinsics.hpp"
#include "poecal/detection/detector.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

struct BoardPictures {
  Target target;
  std::vector<BoardView> views;    ///< one per picture, sorted by name; without points where the board was not found, and of a copy
  std::vector<PictureNote> notes;  ///< as detect() gives them; and of every copy of another picture, which is left out
  int width = 0, height = 0;       ///< of the pictures
};

/// Finds the target of folder/target.yaml in every picture of the folder.
/// @param known  as detect() takes them.
/// @throws FileError: no pictures, none that can be read, no target.yaml or an error in it. Otherwise as detect().
BoardPictures readBoardPictures(const std::filesystem::path& folder, const DetectOptions& options, KnownCorners* known = nullptr);

}  // namespace poecal
