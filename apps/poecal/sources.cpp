#include "sources.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "numbers.hpp"
#include "poecal/core/error.hpp"
#include "poecal/robot/robot_file.hpp"

namespace poecal::app {

CLI::Option* addCaptureOption(CLI::App& app, CaptureSource& source) {
  CLI::Option* capture = app.add_option("CAPTURE", source.folder, "Capture folder");
  app.add_option("--intrinsics", source.intrinsics, "A camera.yaml instead of the one that the capture names")->needs(capture);
  return capture;
}

CLI::Option* addMeasuredCaptureOption(CLI::App& app, CaptureSource& source) {
  CLI::Option* capture = addCaptureOption(app, source);
  app.add_option("--detections", source.detections, "A detections.csv with corners found earlier; no picture is read")->needs(capture);
  return capture;
}

void addArmSource(CLI::App& app, ArmSource& source, IdentifyOptions& options) {
  CLI::Option* capture = addMeasuredCaptureOption(app, source.capture);
  CLI::Option* robot =
      app.add_option("--robot", source.poses.robot, "robot.yaml or URDF, with --poses instead of a capture")->excludes(capture);
  CLI::Option* poses =
      app.add_option("--poses", source.poses.poses, "poses.csv: joints and T_instrument_tool")->needs(robot)->excludes(capture);
  robot->needs(poses);
  app.add_option("--base-link", source.poses.base_link, "Name of the base link, if the robot is a URDF")->needs(robot);
  app.add_option("--tip-link", source.poses.tip_link, "Name of the flange link, if the robot is a URDF")->needs(robot);
  app.add_option("--registration", source.poses.registration,
                 "Known transforms: registration.yaml with T_camera_base (instrument) or T_flange_target (tool)")
      ->needs(poses);
  app.add_flag("--registered", options.registered, "The poses are T_base_flange: nothing needs to be registered")->needs(poses);
}

void requireArmOf(const Model& model, const std::filesystem::path& model_file, const Arm& nominal, const std::filesystem::path& robot) {
  const std::string difference = differenceOfArms(*model.cell.arm, nominal);
  if (!difference.empty()) throw FileError(robot, 0, fmt::format("is not the arm of {}: {}", model_file.string(), difference));
}

void requireLinksOf(const Model& model, const std::filesystem::path& robot, const std::string& base_link, const std::string& tip_link) {
  const bool urdf = isUrdf(robot);
  const auto require = [&robot, urdf](const char* option, const std::string& link, const std::string& of_model) {
    if (link.empty() || of_model.empty() || link == of_model || (urdf && !hasLink(robot, of_model))) return;
    throw InvalidArgument(fmt::format("{} is '{}', expected '{}' as in the model", option, link, of_model));
  };
  require("--base-link", base_link, model.base_link);
  require("--tip-link", tip_link, model.tip_link);
}

CalibrationRun runSource(const std::string& command, const ArmSource& source, const std::filesystem::path& out, CalibrateOptions options,
                         const ResultFiles& files, const Common& common) {
  options.jobs = common.jobs;
  TerminalListener listener(common);
  if (!source.capture.folder.empty()) return runCapture(source.capture, out, options, files, listener);
  if (source.poses.poses.empty()) throw InvalidArgument(command + " needs a CAPTURE, or --robot and --poses");
  return runPoses(source.poses, out, options, files, listener);
}

void addToleranceOptions(CLI::App& app, IdentifyOptions& options) {
  app.add_option("--tolerance-position", options.tolerance_position,
                 "How far an axis may be from its nominal place, 1 sigma [m]; 0: any distance")
      ->capture_default_str()
      ->check(nonNegativeNumber());
  app.add_option("--tolerance-rotation", options.tolerance_rotation, "How far an axis may be tilted, 1 sigma [rad]; 0: any angle")
      ->capture_default_str()
      ->check(nonNegativeNumber());
}

void addIdentifyOptions(CLI::App& app, IdentifyOptions& options) {
  app.add_option_function<std::string>(
         "--method", [&options](const std::string& name) { options.method = methodFromName(name); },
         "gao (the paper's algorithm), weighted (poses by their covariance) or bundle (all corners at once, the default)")
      ->check(CLI::IsMember({"gao", "weighted", "bundle"}));
  addToleranceOptions(app, options);
  app.add_option("--hold-out", options.hold_out_every,
                 "Number N of cross-validation folds: every N-th pose is held out, in N turns; 0: none")
      ->capture_default_str()
      ->check(nonNegativeNumber());
  app.add_flag("--leave-one-out", options.leave_one_out, "Hold out each pose alone (automatic up to 25 poses)");
  app.add_flag("!--no-robust", options.robust, "Plain least squares: outliers keep their weight");
  app.add_flag("--allow-still-joints", options.allow_still_joints,
               "Keep the nominal axis of a joint that never moved; otherwise that is an error");
  app.add_option_function<std::string>(
         "--camera",
         [&options](const std::string& name) {
           options.camera = name == "stated" ? CameraChoice::kStated : name == "free" ? CameraChoice::kFree : CameraChoice::kAuto;
         },
         "stated (keep the lens), free (fit it with the arm) or auto (default: fit it within its stated deviations or, where it states "
         "none, if held-out poses are clearly better for it)")
      ->check(CLI::IsMember({"auto", "stated", "free"}));
}

}  // namespace poecal::app
