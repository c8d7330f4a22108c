// Options that several commands share: where measurements come from, and how an arm is identified.
#pragma once

#include <filesystem>
#include <string>

#include "poecal/calibration/run_capture.hpp"
#include "terminal.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace poecal::app {

/// Adds CAPTURE and --intrinsics. @returns CAPTURE.
CLI::Option* addCaptureOption(CLI::App& app, CaptureSource& source);
/// Adds CAPTURE, --intrinsics and --detections. @returns CAPTURE.
CLI::Option* addMeasuredCaptureOption(CLI::App& app, CaptureSource& source);

/// Where an arm and its measurements come from: a capture, or a robot with poses of any instrument.
struct ArmSource {
  CaptureSource capture;
  PosesSource poses;
};
void addArmSource(CLI::App& app, ArmSource& source, IdentifyOptions& options);

/// @throws FileError: the nominal arm of `robot` is not the one of which `model_file` is a calibration.
void requireArmOf(const Model& model, const std::filesystem::path& model_file, const Arm& nominal, const std::filesystem::path& robot);

/// @throws InvalidArgument: --base-link or --tip-link names another link than the model's arm is between, and the robot's file, where it is
/// a URDF, has that one. Empty ones are not judged.
void requireLinksOf(const Model& model, const std::filesystem::path& robot, const std::string& base_link, const std::string& tip_link);

/// Calibrates whichever of the two was given. @throws InvalidArgument where neither was; otherwise as runCapture().
CalibrationRun runSource(const std::string& command, const ArmSource& source, const std::filesystem::path& out, CalibrateOptions options,
                         const ResultFiles& files, const Common& common);

/// Adds the options that `identify` and `run` share.
void addIdentifyOptions(CLI::App& app, IdentifyOptions& options);
/// Of these the arm's tolerances.
void addToleranceOptions(CLI::App& app, IdentifyOptions& options);

}  // namespace poecal::app
