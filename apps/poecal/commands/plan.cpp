// poecal plan: the next poses worth taking, or a whole first capture.
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "numbers.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/planning/plan_files.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

struct Arguments {
  PlanSource source;
  FirstCapture first;
  PlanOptions options;
  bool separate = false;
  std::vector<std::string> detect;
  std::filesystem::path out;
};

constexpr const char* kExample = R"(
Example:
  $ poecal plan capture --model out/model.yaml --count 20 --out next.csv
  next.csv: 20 poses, in an order that makes a short path
  tool uncertainty now 0.154 mm, 0.397 mrad (1 sigma, mean over the workspace)
  after these 20 poses 0.102 mm, 0.343 mrad; random visible poses would need 68
  checked: joint limits, view, straight links of radius 52 mm against camera, line of sight and flange
  not checked: bent links, cables, grippers, fences and the way between poses; look at them in a simulation first

Before the first picture, with the places of camera and target roughly known:
  $ poecal plan --robot robot.yaml --camera camera.yaml --target target.yaml --camera-at 0.35 0.1 -0.4 --look-at 0.35 0.1 0.3 --out first.csv
)";

std::string toolText(const ToolUncertainty& tool) {
  return fmt::format("{:.3f} mm, {:.3f} mrad", 1e3 * tool.position, 1e3 * tool.rotation);
}

std::string randomText(const Plan& plan) {
  return plan.random_poses ? fmt::format("random visible poses would need {}", *plan.random_poses)
                           : fmt::format("{} random visible poses do not bring that", plan.random_tried);
}

/// No answer is certain.
std::string percentText(double probability) {
  constexpr double kSure = 0.99;
  if (probability > kSure) return "over 99 %";
  return probability < 1.0 - kSure ? "under 1 %" : fmt::format("{:.0f} %", 100.0 * probability);
}

/// "3.4 : 1", "1 : 2.1".
std::string oddsText(double odds) {
  constexpr double kMany = 1000.0;
  if (odds > kMany) return fmt::format("over {:.0f} : 1", kMany);
  const auto number = [](double times) { return times < 10.0 ? fmt::format("{:.1f}", times) : fmt::format("{:.0f}", times); };
  if (odds < 1.0 / kMany) return fmt::format("1 : over {:.0f}", kMany);
  return odds >= 1.0 ? number(odds) + " : 1" : "1 : " + number(1.0 / odds);
}

std::string summaryText(const Arguments& arguments, const Plan& plan, double corner_sigma) {
  const bool first = arguments.source.capture.folder.empty();
  std::string text = fmt::format("{}: {} poses, in an order that makes a short path\n", arguments.out.string(), plan.poses.size());
  for (const RivalOdds& odds : plan.odds) {
    text += fmt::format("if {} is right: its odds over {} are {} now, {} expected\n", odds.right, odds.wrong, oddsText(odds.before),
                        oddsText(odds.expected));
  }
  for (const std::string& rival : plan.not_told) text += "not told by other poses: " + rival + "\n";
  if (plan.detection_after) {
    text += fmt::format("{} of size {:g}: expected S now {:.1f}, found with {}; after these poses S {:.1f}, found with {}\n",
                        arguments.options.detect, arguments.options.detect_size, std::sqrt(plan.detection_before->chi_square),
                        percentText(plan.detection_before->probability), std::sqrt(plan.detection_after->chi_square),
                        percentText(plan.detection_after->probability));
  }
  if (!plan.odds.empty() || plan.detection_after) text += randomText(plan) + "\n";
  text += fmt::format("tool uncertainty now {} (1 sigma, mean over the workspace{})\n", toolText(plan.before),
                      first ? fmt::format("; from what is stated, corners of {:.2g} px", corner_sigma) : "");
  text += fmt::format("after these {} poses {}", plan.poses.size(), toolText(plan.after));
  text += arguments.options.aim == PlanAim::kTool ? "; " + randomText(plan) + "\n" : "\n";
  constexpr double kHardly = 0.95;
  if (arguments.options.aim == PlanAim::kTool && plan.after.position > kHardly * plan.before.position) {
    text +=
        "poses hardly help any more: the rest depends on what no picture shows, such as the true size of the tag, or on places never in "
        "view\n";
  }
  if (plan.sides_matter) text += "dir1.. is part of the plan: let each joint come from that side (1: from below)\n";
  text += fmt::format("checked: joint limits, view, straight links of radius {:.0f} mm against camera, line of sight and flange{}\n",
                      1e3 * plan.link_radius, arguments.options.floor ? ", and the floor" : "");
  text += "not checked: bent links, cables, grippers, fences and the way between poses; look at them in a simulation first\n";
  return text;
}

nlohmann::json toolJson(const ToolUncertainty& tool) {
  return {{"position_mm", 1e3 * tool.position}, {"rotation_mrad", 1e3 * tool.rotation}};
}

nlohmann::json detectionJson(const Detection& detection) {
  return {{"chi_square", detection.chi_square}, {"probability", detection.probability}};
}

nlohmann::json summaryJson(const Arguments& arguments, const Plan& plan) {
  nlohmann::json json{{"out", arguments.out.string()},
                      {"poses", plan.poses.size()},
                      {"before", toolJson(plan.before)},
                      {"after", toolJson(plan.after)},
                      {"random_tried", plan.random_tried},
                      {"visible", plan.visible},
                      {"drawn", plan.drawn}};
  json["random_poses"] = plan.random_poses ? nlohmann::json(*plan.random_poses) : nlohmann::json();
  for (const RivalOdds& odds : plan.odds) {
    json["odds"].push_back({{"right", odds.right}, {"wrong", odds.wrong}, {"before", odds.before}, {"expected", odds.expected}});
  }
  if (!plan.not_told.empty()) json["not_told"] = plan.not_told;
  if (plan.detection_after) {
    json["detection"] = {{"before", detectionJson(*plan.detection_before)}, {"after", detectionJson(*plan.detection_after)}};
  }
  return json;
}

std::vector<std::filesystem::path> inputsOf(const Arguments& arguments) {
  std::vector<std::filesystem::path> inputs{arguments.source.model,
                                            arguments.source.capture.intrinsics,
                                            arguments.source.capture.detections,
                                            arguments.first.robot,
                                            arguments.first.camera,
                                            arguments.first.target,
                                            arguments.first.registration};
  if (!arguments.source.capture.folder.empty()) {
    for (const std::filesystem::path& file : filesOf(readCapture(arguments.source.capture.folder), true)) inputs.push_back(file);
  }
  std::erase_if(inputs, [](const std::filesystem::path& file) { return file.empty(); });
  return inputs;
}

void requireSource(const Arguments& arguments) {
  if (arguments.source.capture.folder.empty()) {
    if (arguments.first.robot.empty()) throw InvalidArgument("plan needs a CAPTURE and --model, or --robot, --camera and --target");
    if (arguments.first.camera.empty() || arguments.first.target.empty()) throw InvalidArgument("--robot needs --camera and --target");
  } else if (arguments.source.model.empty()) {
    throw InvalidArgument("a CAPTURE needs --model");
  }
}

void takeAim(Arguments& arguments) {
  PlanOptions& options = arguments.options;
  if (arguments.separate) options.aim = PlanAim::kSeparate;
  if (arguments.detect.empty()) return;
  options.aim = PlanAim::kDetect;
  options.detect = arguments.detect.front();
  try {
    std::size_t used = 0;
    options.detect_size = std::stod(arguments.detect.back(), &used);
    if (used == arguments.detect.back().size()) return;
  } catch (const std::logic_error&) {
  }
  throw InvalidArgument(fmt::format("--detect: '{}' is no size, expected a number in the effect's unit", arguments.detect.back()));
}

int run(Arguments& arguments, const Common& common) {
  requireSource(arguments);
  takeAim(arguments);
  requireOutputs({arguments.out}, inputsOf(arguments));
  const bool first = arguments.source.capture.folder.empty();
  const PlanningCell cell = first ? firstCapture(arguments.first) : readPlanningCell(arguments.source);
  arguments.options.jobs = common.jobs;
  TerminalListener listener(common);
  arguments.options.progress = listener.progressFunction();
  const Plan plan = planPoses(cell, arguments.options);
  writeTextFile(arguments.out, planCsv(plan, cell.taken.samples.size()));
  printSummary(common, summaryText(arguments, plan, cell.noise.corner), summaryJson(arguments, plan));
  return 0;
}

/// @param point  an Eigen::Vector3d, or an optional one
template <typename Point>
CLI::Option* addPoint(CLI::App& app, const std::string& name, Point& point, const std::string& help) {
  return app
      .add_option_function<std::vector<double>>(
          name, [&point](const std::vector<double>& p) { point = Eigen::Vector3d(p[0], p[1], p[2]); }, help)
      ->expected(3)
      ->type_name("X Y Z");
}

void addFirstOptions(CLI::App& app, FirstCapture& first, CLI::Option* folder) {
  CLI::Option* robot = app.add_option("--robot", first.robot, "robot.yaml or URDF: plans a whole first capture")->excludes(folder);
  app.add_option("--base-link", first.base_link, "Name of the base link, if the robot is a URDF")->needs(robot);
  app.add_option("--tip-link", first.tip_link, "Name of the flange link, if the robot is a URDF")->needs(robot);
  app.add_option("--camera", first.camera, "camera.yaml, with --robot")->needs(robot);
  app.add_option("--target", first.target, "target.yaml, with --robot")->needs(robot);
  app.add_option_function<std::string>(
         "--setup",
         [&first](const std::string& name) { first.setup = name == setupName(Setup::kEyeInHand) ? Setup::kEyeInHand : Setup::kEyeToHand; },
         "eye_to_hand (default) or eye_in_hand")
      ->check(CLI::IsMember({setupName(Setup::kEyeToHand), setupName(Setup::kEyeInHand)}));
  CLI::Option* registration =
      app.add_option("--registration", first.registration, "A registration.yaml that says where camera and target roughly are");
  addPoint(app, "--camera-at", first.camera_at, "Where the camera roughly is, in base [m]; eye in hand: in flange")->excludes(registration);
  addPoint(app, "--look-at", first.look_at, "A point that it looks at, in the same frame [m]")->excludes(registration);
  addPoint(app, "--target-at", first.target_at, "The target's centre in flange [m] (default 0 0 0); eye in hand: in base")
      ->excludes(registration);
  addPoint(app, "--target-faces", first.target_faces, "Direction that its front faces, in the same frame (default 0 0 1)")
      ->excludes(registration);
  app.add_option("--corner-sigma", first.corner_sigma, "Noise to expect of a corner's u and v before the first picture, 1 sigma [px]")
      ->capture_default_str()
      ->check(positiveNumber());
  app.add_option("--rough-position", first.rough_position, "How well these places are known, 1 sigma [m]")
      ->capture_default_str()
      ->check(positiveNumber());
  app.add_option("--rough-rotation", first.rough_rotation, "How well their directions are known, 1 sigma [rad]")
      ->capture_default_str()
      ->check(positiveNumber());
}

void addPlanOptions(CLI::App& app, PlanOptions& options) {
  app.add_option("--count", options.count, "Poses to plan")->capture_default_str()->check(positiveNumber());
  app.add_option_function<std::string>(
         "--criterion", [&options](const std::string& name) { options.criterion = name == "d" ? PlanCriterion::kD : PlanCriterion::kA; },
         "a (default): least mean variance of the tool's position; d: least volume of the confidence region of all unknowns")
      ->check(CLI::IsMember({"a", "d"}));
  app.add_option("--candidates", options.candidates, "Visible random poses to choose from")->capture_default_str()->check(positiveNumber());
  app.add_option("--seed", options.seed, "Of the candidates")->capture_default_str();
  app.add_option("--link-radius", options.link_radius, "Half the thickness of the links [m]; 0: 4 % of the arm's length")
      ->capture_default_str()
      ->check(nonNegativeNumber());
  app.add_option("--camera-radius", options.camera_radius,
                 "Of a ball around the camera that no link enters [m]; eye in hand: around the target")
      ->capture_default_str()
      ->check(nonNegativeNumber());
  app.add_option("--floor", options.floor, "Height of the floor above the origin of base [m]; without it no floor is checked");
}

}  // namespace

std::function<int()> setUpPlan(CLI::App& app, const Common& common) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::Option* folder = app.add_option("CAPTURE", arguments->source.capture.folder, "Capture folder that the model was found from");
  app.add_option("--model", arguments->source.model, "Its model.yaml")->needs(folder);
  app.add_option("--intrinsics", arguments->source.capture.intrinsics, "A camera.yaml instead of the capture's")->needs(folder);
  app.add_option("--detections", arguments->source.capture.detections,
                 "A detections.csv instead of the capture's, or of that beside the model")
      ->needs(folder);
  CLI::Option* separate =
      app.add_flag("--separate", arguments->separate,
                   "Poses that tell apart what diagnosis.json beside the model left open, instead of making the tool certain")
          ->needs(folder);
  app.add_option("--detect", arguments->detect,
                 "Poses that would show an effect of that size (in its unit, see poecal effects NAME), as joint_coupling@joint:6 0.0005 or "
                 "joint_coupling@joint:6/q5 0.0005")
      ->expected(2)
      ->type_name("EFFECT@PLACE SIZE")
      ->excludes(separate);
  app.add_option("--odds", arguments->options.odds, "Expected odds at which --separate takes no further pose")
      ->capture_default_str()
      ->needs(separate);
  app.add_option("--out", arguments->out, "The table to write: q1..qn, as samples.csv has it")->required();
  addPlanOptions(app, arguments->options);
  addFirstOptions(app, arguments->first, folder);
  app.footer(kExample);
  return [arguments, &common] { return run(*arguments, common); };
}

}  // namespace poecal::app
