// What the way from one row to the next says of the columns beside the readings.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// Stamps between which most rows would have moved at impossibleSpeed(): of another unit than seconds. One sentence at most, with file and
/// line of the fastest row.
std::vector<std::string> speedRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm);

/// dir columns that hold 0 in place of -1; or that nearly all rows contradict, each taken to come from the row before: of the other sign,
/// of another joint, or of the next row. One sentence for all columns of a kind, with the file. A column that agrees with nothing is no
/// contradiction: controllers may come to a pose from a side of their own.
std::vector<std::string> directionRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm);

}  // namespace poecal
