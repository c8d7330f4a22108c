#include "identifying.hpp"

#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/registration/implausible.hpp"

namespace poecal::app {
namespace {

std::string errorText(const ErrorSummary& errors) {
  if (errors.poses == 0) return "-";
  std::string text;
  if (errors.corners > 0) text = fmt::format("{:9.3f} px   ", errors.px.rms);
  text += fmt::format("{:8.3f} mm", 1e3 * errors.position.mean);
  const bool positions_alone = errors.corners == 0 && errors.rotation.max == 0.0;
  return positions_alone ? text : text + fmt::format(" {:8.3f} mrad", 1e3 * errors.rotation.mean);
}

/// nominal -> registered -> identified, on calibration and on held-out poses.
std::string ladder(const Identification& identification) {
  const bool pixels = identification.stages.front().calibration.corners > 0;
  std::string text = fmt::format("  {:<12}{:<42}{}\n", "", "calibration",
                                 identification.leave_one_out ? "each pose held out alone" : "poses that the fit did not see");
  text += fmt::format("  {:<12}{}\n", "", pixels ? "px rms, mean mm and mrad at the flange" : "mean mm and mrad");
  for (const Stage& stage : identification.stages) {
    text += fmt::format("  {:<12}{:<42}{}\n", stage.name, errorText(stage.calibration), errorText(stage.held_out));
  }
  return text;
}

std::string suspectText(const Identification& identification, const std::vector<Sample>& samples) {
  constexpr std::size_t kShown = 20;
  std::string text;
  for (std::size_t k = 0; k < identification.suspects.size() && k < kShown; ++k) {
    const SuspectRow& row = identification.suspects[k];
    const Sample& sample = samples[row.sample];
    text += fmt::format("  {}: line {}{}, {:.1f} sigma\n", row.left_out ? "left out" : "outlier", sample.line,
                        sample.image.empty() ? "" : " (" + sample.image + ")", row.sigmas);
  }
  if (identification.suspects.size() > kShown) {
    text += fmt::format("  and {} more, see identification.json\n", identification.suspects.size() - kShown);
  }
  return text;
}

Identifying finish(Identification identification, const std::vector<Sample>& samples, const std::filesystem::path& out) {
  const std::string report = identificationJson(identification, samples);
  writeTextFile(out / "model.yaml", modelYaml(identification.model));
  writeTextFile(out / "identification.json", report);
  warnAll(identification.warnings);
  Identifying result;
  result.text = fmt::format("identified {} by {} from {} poses\n", identification.model.cell.arm->name, methodName(identification.method),
                            identification.poses);
  if (!identification.stages.empty()) result.text += ladder(identification);
  if (identification.model.cell.camera && identification.method == Method::kBundle) {
    result.text += identification.sigmas_stated
                       ? fmt::format("  noise {:.3f} of what the corners state, chi-square per degree of freedom {:.3f}\n",
                                     identification.scale, identification.reduced_chi_square)
                       : fmt::format("  noise {:.3f} px per axis\n", identification.scale);
  }
  result.text += suspectText(identification, samples);
  result.json = nlohmann::json::parse(report);
  result.identification = std::move(identification);
  return result;
}

/// The rows of a table of poses as samples.
std::vector<Sample> samplesOf(const PoseTable& table) {
  std::vector<Sample> samples;
  for (const MeasuredPose& pose : table.poses) samples.push_back(pose.sample);
  return samples;
}

}  // namespace

void addToleranceOptions(CLI::App& app, IdentifyOptions& options) {
  app.add_option("--tolerance-position", options.tolerance_position, "Prior of an axis' place about the nominal, 1 sigma [m]; 0: none")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--tolerance-rotation", options.tolerance_rotation, "Prior of an axis' tilt, 1 sigma [rad]; 0: none")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
}

void addIdentifyOptions(CLI::App& app, IdentifyOptions& options) {
  app.add_option_function<std::string>(
         "--method", [&options](const std::string& name) { options.method = methodFromName(name); },
         "gao (the paper's algorithm), weighted, or bundle (default)")
      ->check(CLI::IsMember({"gao", "weighted", "bundle"}));
  addToleranceOptions(app, options);
  app.add_option("--hold-out", options.hold_out_every,
                 "Every how-manieth pose judges a fit instead of entering it, in as many turns; 0: none")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--leave-one-out", options.leave_one_out, "Each pose judges alone (done by itself up to 25 poses)");
  app.add_flag("!--no-robust", options.robust, "Plain least squares: no row loses weight");
  app.add_flag("--allow-still-joints", options.allow_still_joints, "A joint that never moved keeps its nominal axis");
  app.add_option_function<std::string>(
         "--camera",
         [&options](const std::string& name) {
           options.camera = name == "stated" ? CameraChoice::kStated : name == "free" ? CameraChoice::kFree : CameraChoice::kAuto;
         },
         "stated (held), free (re-fitted), or auto (default): as a nuisance within its stated deviations, or re-fitted where held-out "
         "poses ask for it")
      ->check(CLI::IsMember({"auto", "stated", "free"}));
}

Identification identifyInputs(const CaptureInputs& inputs, IdentifyOptions options, const RegistrationResult* registration) {
  const Capture& capture = inputs.capture;
  if (!inputs.cell.arm) {
    throw InsufficientData(fmt::format("{} has no joint readings (columns q1, q2, ...): only registration is possible (poecal measure)",
                                       capture.table.file.string()));
  }
  for (const ImageCorners& image : inputs.detections.images) {
    for (const Corner& corner : image.corners) options.sigmas_stated = options.sigmas_stated || std::isfinite(corner.sigma);
  }
  Identification identification;
  try {
    identification =
        identify(inputs.cell, inputs.observations, observationGroups(inputs.observations, capture.table.samples), options, registration);
  } catch (const ImplausibleInput& suspicion) {
    throw fileErrorOf(suspicion, capture);
  }
  Model& model = identification.model;
  model.target = capture.target;
  if (!capture.base_link.empty()) {
    model.urdf = capture.robot_file.filename().string();
    model.base_link = capture.base_link;
    model.tip_link = capture.tip_link;
  }
  return identification;
}

std::vector<Observation> instrumentObservations(const PoseTable& table) {
  // Where the table states no deviations these are only where their estimation starts.
  return poseObservations(table, 1e-3, 3e-3);
}

Identification identifyTable(const Arm& arm, const PoseTable& table, IdentifyOptions options) {
  Cell cell;
  cell.arm = arm;
  options.sigmas_stated = !table.poses.empty();
  for (const MeasuredPose& pose : table.poses) {
    options.sigmas_stated = options.sigmas_stated && pose.sigma_position && (pose.sigma_rotation || pose.position_only);
  }
  const std::vector<Observation> observations = instrumentObservations(table);
  try {
    return identify(cell, observations, observationGroups(observations, samplesOf(table)), options);
  } catch (const ImplausibleInput& suspicion) {
    throw fileErrorOf(suspicion, table);
  }
}

Identifying identifyCapture(const CaptureInputs& inputs, const IdentifyOptions& options, const std::filesystem::path& out,
                            const RegistrationResult* registration) {
  return finish(identifyInputs(inputs, options, registration), inputs.capture.table.samples, out);
}

Identifying identifyPoses(const Arm& arm, const PoseTable& table, const IdentifyOptions& options, const std::filesystem::path& out) {
  return finish(identifyTable(arm, table, options), samplesOf(table), out);
}

void addArmSource(CLI::App& app, ArmSource& source, IdentifyOptions& options) {
  CLI::Option* capture = addMeasuredCaptureOption(app, source.capture);
  CLI::Option* robot = app.add_option("--robot", source.robot, "robot.yaml or URDF, with --poses instead of a capture")->excludes(capture);
  CLI::Option* poses = app.add_option("--poses", source.poses, "poses.csv: joints and T_instrument_tool")->needs(robot)->excludes(capture);
  robot->needs(poses);
  app.add_option("--base-link", source.base_link, "Base link, where the robot is a URDF")->needs(robot);
  app.add_option("--tip-link", source.tip_link, "Tip link, where the robot is a URDF")->needs(robot);
  app.add_flag("--registered", options.registered, "The poses are T_base_flange already")->needs(poses);
}

void requireArmSource(const std::string& command, const ArmSource& source) {
  if (source.capture.folder.empty() && source.poses.empty()) throw InvalidArgument(command + " needs a CAPTURE, or --robot and --poses");
}

}  // namespace poecal::app
