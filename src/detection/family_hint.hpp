// Where no tag was found: whether the pictures show tags of another family than the stated one, or show them mirrored.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "poecal/detection/detector.hpp"

namespace poecal {

/// Looks at a few of `images` for all families but `family`; a note where one was seen.
std::optional<PictureNote> hintAtFamily(const std::filesystem::path& folder, const std::vector<std::string>& images,
                                        const std::string& family);

/// The first of a few of `images` that shows tags of `family` once it is mirrored.
std::optional<std::string> findMirrored(const std::filesystem::path& folder, const std::vector<std::string>& images,
                                        const std::string& family);

}  // namespace poecal
