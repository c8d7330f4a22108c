// Contradictions between the rows of a capture and what belongs to them: the arm, the pictures.
#pragma once

#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// Holds the flange poses of a table against its joint readings, up to a frame of their own and a tool: two transforms that stay the same.
/// @return remarks on single rows that disagree. @throws FileError with the line where more do.
std::vector<std::string> compareFlangePoses(const Arm& arm, const SampleTable& table);

/// Looks for rows whose pictures are one file under two names; pictures without anything in them are passed over.
/// @return remarks on rows whose readings are equal too. @throws FileError with both names and lines where they are not.
std::vector<std::string> compareBytesOfPictures(const Capture& capture);

}  // namespace poecal
