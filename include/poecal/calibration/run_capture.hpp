// The main job from files to files: what the commands run, measure, identify and diagnose do.
#pragma once

#include <filesystem>
#include <string>

#include "poecal/calibration/calibrate.hpp"
#include "poecal/calibration/load_capture.hpp"
#include "poecal/calibration/results.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// A calibration with what it was made from.
struct CalibrationRun {
  Measurements measurements;
  Calibration calibration;
};

/// Calibrates a capture folder and writes the files of `files` into `out`; camera.yaml and detections.csv too where they had to be found
/// (see loadCapture()). What is up to date there is not done again, and a killed run goes on where it was.
/// @param listener  told of warnings and progress.
/// @throws FileError, InsufficientData as loadCapture() and calibrate(); contradictions name the file that holds them.
CalibrationRun runCapture(const CaptureSource& source, const std::filesystem::path& out, const CalibrateOptions& options,
                          const ResultFiles& files, Listener& listener);

/// An arm's file, and poses of any instrument.
struct PosesSource {
  std::filesystem::path robot, poses;
  std::string base_link = {}, tip_link = {};  ///< where the robot is a URDF
  std::filesystem::path registration = {};    ///< known transforms, see readKnownRegistration(); empty: none
};
/// The same from poses of an instrument: its frame takes the camera's place, its tool the target's.
CalibrationRun runPoses(const PosesSource& source, const std::filesystem::path& out, const CalibrateOptions& options,
                        const ResultFiles& files, Listener& listener);

}  // namespace poecal
