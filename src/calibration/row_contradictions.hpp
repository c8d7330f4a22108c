// Contradictions between the rows of a capture and what belongs to them: the arm, the pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// Holds the flange poses of a table against its joint readings, up to a frame of their own and a tool: two transforms that stay the same.
/// @return remarks on single rows that disagree. @throws FileError with the line where more do.
std::vector<std::string> compareFlangePoses(const Arm& arm, const SampleTable& table);

/// Looks for rows whose pictures are one file under two names; pictures without anything in them are passed over.
/// @param progress  told of each picture that is read.
/// @return remarks on rows whose readings are equal too. @throws FileError with both names and lines where they are not.
std::vector<std::string> compareBytesOfPictures(const Capture& capture, const ProgressFunction& progress = {});

/// The same of corners that were found earlier: no two pictures of a camera show every corner at the same fractions of a pixel.
/// @return remarks on such rows. @throws FileError with both names and lines where the readings of more than a tenth of the rows are not
/// equal too: single ones a calibration leaves out.
std::vector<std::string> compareCornersOfPictures(const SampleTable& table, const Detections& detections);

/// Corners that were rounded to whole pixels, of all or of some pictures. One sentence at most.
std::vector<std::string> remarksOnCorners(const std::filesystem::path& file, const Detections& detections);

/// What rows say against each other, or lack: stamps, temperatures, whole turns, readings that were rounded coarsely.
/// @param arm  nullptr where there are no joint readings.
std::vector<std::string> remarksOnRows(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm);

}  // namespace poecal
