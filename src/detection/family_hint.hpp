// Where nothing of a target was found: whether the pictures show it mirrored, or show tags or markers of another kind than the stated one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "poecal/detection/detector.hpp"

namespace poecal {

/// Looks at a few of `images` for all other tag families (of a target of tags) or marker dictionaries (of a ChArUco board); a note where
/// one was seen.
std::optional<PictureNote> hintAtFamily(const std::filesystem::path& folder, const std::vector<std::string>& images, const Target& target);

/// The first of a few of `images` that shows the tags or the ChArUco board of `target` once it is mirrored. A mirrored chessboard is one
/// too.
std::optional<std::string> findMirrored(const std::filesystem::path& folder, const std::vector<std::string>& images, const Target& target);

}  // namespace poecal
