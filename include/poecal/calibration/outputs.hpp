// Results must not take the place of what they are made from.
#pragma once

#include <filesystem>
#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// Called before any work is done.
/// @throws InvalidArgument where a result would replace an input, by whatever name: another path, a symbolic or a hard link, or where two
/// results have one place. FileError
/// where something is in its place that no result must replace (a folder, a device, a link).
void requireOutputs(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs);

/// The files of OUT that a report of its results is written to. They are made from the others, and not kept where somebody changed them.
std::vector<std::filesystem::path> reportFiles(const std::filesystem::path& out);

/// The files of a capture, those that it names and its pictures. @param detections  whether that of corners found earlier is one too.
std::vector<std::filesystem::path> filesOf(const Capture& capture, bool detections);
/// Likewise of a folder with pictures of a board.
std::vector<std::filesystem::path> filesOfBoard(const std::filesystem::path& folder);

}  // namespace poecal
