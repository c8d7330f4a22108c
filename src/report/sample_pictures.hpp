// Small pictures of samples for the page.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "poecal/core/progress.hpp"

namespace poecal {

/// JSON text: {"wanted", "pictures": [{"row", "whole", "part": [u, v, width, height], "near"}]}. `wanted` is how many were looked for,
/// `row` one of the report's samples; `whole` and `near` are JPEGs as data URIs: the whole picture, and the part of it around the corners.
/// @param report   of poecal-report/1. @param folder  of the pictures.
/// @param kept  a file that holds the text from last time and the key of what it was made from; empty: none.
/// @param progress  told of each picture that is made.
/// @param most_bytes  of the text; where there are too many pictures for it, the worst samples and an even choice of the others are kept.
std::string samplePictures(const nlohmann::ordered_json& report, const std::filesystem::path& folder, std::size_t most_bytes, int jobs,
                           const std::filesystem::path& kept, const ProgressFunction& progress);

}  // namespace poecal
