// A capture folder ready for calibration: its camera and corners are found on the way where the capture asks for it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/cell/measurements.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/detection/detector.hpp"

namespace poecal {

class ResultRecord;

/// A capture folder, and files made earlier that take the place of what it names.
struct CaptureSource {
  std::filesystem::path folder;
  std::filesystem::path intrinsics = {};  ///< a camera.yaml; empty: as the capture says
  std::filesystem::path detections = {};  ///< a detections.csv; empty: as the capture says
  std::filesystem::path identified = {};  ///< a folder with an identification that must be of this capture; empty: not asked
};
/// readCapture() with the files of `source` in their places.
Capture openCapture(const CaptureSource& source);

/// A capture with what its pictures gave.
struct LoadedCapture {
  std::shared_ptr<const ResultRecord> record;  ///< of OUT; the results are noted down there when the last copy of it goes
  Capture capture;
  Cell nominal;  ///< arm as drawn, only where there are joint readings; camera as stated or found; of the registration what the capture
                 ///< says is known
  Measurements measurements;
};

/// Reads a capture. Intrinsics are found from their pictures where it names a folder of them (OUT/camera.yaml), corners where it names no
/// detections.csv (OUT/detections.csv, OUT/detections-pictures.csv); what stands in OUT from the same inputs is not done again, picture by
/// picture.
/// @param jobs  pictures at a time; 0: one per core. The result does not depend on it.
/// A result that somebody changed since it was written is told, and a copy of it is kept beside it (model.yaml: model.edited.yaml).
/// @throws FileError, InsufficientData as the readers and the detector do; InvalidArgument where a result would replace an input;
/// InsufficientData where no sample has corners of the target.
LoadedCapture loadCapture(const CaptureSource& source, const std::filesystem::path& out, int jobs, Listener& listener);

/// What is written into OUT of a capture, by whichever command.
std::vector<std::filesystem::path> resultsOf(const Capture& capture, const std::filesystem::path& out);

/// The file in which the corners that were found for results in `folder` are kept from run to run.
std::filesystem::path knownCornersFile(const std::filesystem::path& folder);

/// Pictures of which none shows the target calibrate nothing. @throws InsufficientData, with the last note: where it is known, it says why.
void requireTarget(const Capture& capture, const DetectResult& result);

}  // namespace poecal
