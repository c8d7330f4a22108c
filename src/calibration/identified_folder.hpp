// Whether a folder holds the identification of the capture at hand.
#pragma once

#include <filesystem>

#include "poecal/calibration/calibrate.hpp"

namespace poecal {

/// Reads FOLDER/model.yaml and holds it against what was identified here from the same measurements.
/// @throws FileError with file and line where it is no model; where its arm, target, camera or setup is another; where it leaves several
/// times what the arm that was identified here leaves in these measurements.
void requireIdentified(const std::filesystem::path& folder, const Calibration& calibration, const Measurements& measurements);

}  // namespace poecal
