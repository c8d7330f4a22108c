// What several commands load alike: a capture with its camera and corners, made on the way where the capture asks for it.
#pragma once

#include <filesystem>

#include "command.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/detection/detector.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace poecal::app {

/// A capture folder, and files made earlier that take the place of what it names.
struct CaptureSource {
  std::filesystem::path folder;
  std::filesystem::path intrinsics;  ///< a camera.yaml; empty: as the capture says
  std::filesystem::path detections;  ///< a detections.csv; empty: as the capture says
};
/// Adds CAPTURE and --intrinsics. @returns CAPTURE.
CLI::Option* addCaptureOption(CLI::App& app, CaptureSource& source);
/// Adds CAPTURE, --intrinsics and --detections. @returns CAPTURE.
CLI::Option* addMeasuredCaptureOption(CLI::App& app, CaptureSource& source);
/// readCapture() with the files of `source` in their places.
Capture openCapture(const CaptureSource& source);

/// The file in which what is found for a result in `folder` is kept from run to run.
std::filesystem::path knownCornersFile(const std::filesystem::path& folder);

/// A capture ready for measuring.
struct CaptureInputs {
  Capture capture;
  Camera camera;
  Detections detections;
  Cell cell;  ///< arm only where there are joint readings
  std::vector<Observation> observations;
};

/// Reads a capture. Intrinsics are found from their pictures where it names a folder of them (OUT/camera.yaml), corners where it names no
/// detections.csv (OUT/detections.csv, OUT/detections-pictures.csv); what stands in OUT from the same inputs is not done again, picture by
/// picture.
CaptureInputs loadCapture(const CaptureSource& source, const std::filesystem::path& out, const Common& common);

/// Pictures of which none shows the target calibrate nothing. @throws InsufficientData, with the last note: where it is known, it says why.
void requireTarget(const Capture& capture, const DetectResult& result);

/// "image: message" of each note.
std::vector<std::string> describe(const std::vector<PictureNote>& notes);

/// Prints the first few of many warnings and how many more there are.
void warnAll(const std::vector<std::string>& messages);

}  // namespace poecal::app
