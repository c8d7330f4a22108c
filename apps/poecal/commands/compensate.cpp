// poecal compensate: the joints to command so that the real arm goes where it should.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/compensation/compensate.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/robot/robot_file.hpp"
#include "sources.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

struct CompensateOptions {
  std::filesystem::path model, poses, joints, robot, out;
  std::string base_link, tip_link;
  bool leave_out = false;
};

std::optional<Arm> nominalArm(const CompensateOptions& options, const Model& model) {
  if (options.robot.empty()) {
    if (options.joints.empty()) return std::nullopt;
    throw InvalidArgument("--joints needs --robot, the nominal arm whose poses the real one should reach");
  }
  requireLinksOf(model, options.robot, options.base_link, options.tip_link);
  const std::string base_link = options.base_link.empty() ? model.base_link : options.base_link;
  const std::string tip_link = options.tip_link.empty() ? model.tip_link : options.tip_link;
  Arm nominal = readArm(options.robot, base_link, tip_link);
  requireArmOf(model, options.model, nominal, options.robot);
  return nominal;
}

/// What is asked for: the poses of the file, or those that the nominal arm means to reach.
SampleTable wantedOf(const CompensateOptions& options, const Model& model, const std::optional<Arm>& nominal) {
  if (!options.poses.empty()) return readWantedPoses(options.poses, *model.cell.arm);
  SampleTable table = readJointTable(options.joints, *nominal);
  for (Sample& sample : table.samples) sample.T_base_flange = forwardKinematics(*nominal, sample.q);
  return table;
}

/// Mean and largest of an error.
struct Figures {
  double mean = 0.0, largest = 0.0;
  void add(double value, std::size_t count) {
    mean += value / static_cast<double>(count);
    largest = std::max(largest, value);
  }
};

struct Summary {
  std::size_t rows = 0, reached = 0;
  Figures position, rotation, position_before, rotation_before;
};

Summary summaryOf(const RealArm& arm, const SampleTable& wanted, const std::vector<JointCommand>& commands) {
  SampleTable plain = wanted;
  for (std::size_t k = 0; k < commands.size(); ++k) plain.samples[k].q = commands[k].start;
  const std::vector<Eigen::Isometry3d> before = reachedPoses(arm, plain);
  Summary summary;
  summary.rows = commands.size();
  for (const JointCommand& command : commands) summary.reached += command.why_not.empty() ? 1 : 0;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    if (!commands[k].why_not.empty()) continue;
    const Eigen::Isometry3d& T = *wanted.samples[k].T_base_flange;
    summary.position.add(commands[k].position_error, summary.reached);
    summary.rotation.add(commands[k].rotation_error, summary.reached);
    summary.position_before.add((T.translation() - before[k].translation()).norm(), summary.reached);
    summary.rotation_before.add(rotationAngle(T.linear() * before[k].linear().transpose()), summary.reached);
  }
  return summary;
}

std::string lineOf(const char* what, const Figures& position, const Figures& rotation) {
  return fmt::format("  {:12} {:>9.3f} {:>9.3f} {:>11.3f} {:>9.3f}\n", what, 1e3 * position.mean, 1e3 * position.largest,
                     1e3 * rotation.mean, 1e3 * rotation.largest);
}

nlohmann::json figuresJson(const Figures& position, const Figures& rotation) {
  return {{"position_mean", position.mean},
          {"position_max", position.largest},
          {"rotation_mean", rotation.mean},
          {"rotation_max", rotation.largest}};
}

void report(const Common& common, const CompensateOptions& options, const Model& model, const Summary& summary, bool nominal_known) {
  std::size_t entered = 0;
  for (const AppliedEffect& applied : model.effects) entered += movesFlange(applied.effect) ? 1 : 0;
  std::string text = fmt::format("joints for {} of {} rows, {} effect{} of the arm compensated: {}\n", summary.reached, summary.rows,
                                 entered, entered == 1 ? "" : "s", options.out.string());
  text += "  flange off by  mean [mm]  max [mm]  mean [mrad] max [mrad]\n";
  if (nominal_known) text += lineOf("as meant", summary.position_before, summary.rotation_before);
  text += lineOf("compensated", summary.position, summary.rotation);
  nlohmann::json json{{"out", options.out.string()},
                      {"rows", summary.rows},
                      {"reached", summary.reached},
                      {"effects", entered},
                      {"compensated", figuresJson(summary.position, summary.rotation)}};
  if (nominal_known) json["as_meant"] = figuresJson(summary.position_before, summary.rotation_before);
  printSummary(common, text, json);
}

/// Rows that cannot be reached: none are left out unless it was asked for, since a program of the robot would have holes there.
void refuseUnreached(const CompensateOptions& options, const Common& common, const SampleTable& wanted,
                     const std::vector<JointCommand>& commands) {
  std::vector<std::string> rows;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    if (commands[k].why_not.empty()) continue;
    rows.push_back(fmt::format("{}:{}: {}", wanted.file.string(), wanted.samples[k].line, commands[k].why_not));
  }
  if (rows.empty()) return;
  if (options.leave_out && rows.size() < commands.size()) {
    TerminalListener(common).warnings(rows);
    return;
  }
  const std::string first = rows.front();
  rows.erase(rows.begin());
  TerminalListener(common).warnings(rows);
  throw InsufficientData(
      fmt::format("{} ({} of {} rows cannot be reached; --leave-out writes the others)", first, rows.size() + 1, commands.size()));
}

/// Near a singular posture a small correction of the flange is a large one of the joints.
void warnOfLargeMoves(const SampleTable& wanted, const std::vector<JointCommand>& commands) {
  constexpr double kLargeMove = 0.1;  // [rad], [m]: 20 times what axes that are off by 2 mrad and 1 mm ask for elsewhere
  std::size_t rows = 0;
  double furthest = kLargeMove;
  std::string example;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    if (!commands[k].why_not.empty()) continue;
    Eigen::Index joint = 0;
    const double moved = (commands[k].q - commands[k].start).cwiseAbs().maxCoeff(&joint);
    if (moved > kLargeMove) ++rows;
    if (moved <= furthest) continue;
    furthest = moved;
    example = fmt::format("q{} by {:.3f} in line {}", joint + 1, moved, wanted.samples[k].line);
  }
  if (rows == 0) return;
  warn(
      fmt::format("{} {} a joint by more than 0.1 rad or m, the largest {}: look at them before the arm does, they may be near a "
                  "singular posture",
                  rows, rows == 1 ? "row moves" : "rows move", example));
}

int runCompensate(const CompensateOptions& options, const Common& common) {
  if (options.poses.empty() == options.joints.empty()) throw InvalidArgument("compensate needs --poses or --joints");
  const Model model = readModel(options.model);
  requireOutputs({options.out}, {options.model, options.poses, options.joints, options.robot});
  const std::optional<Arm> nominal = nominalArm(options, model);
  const SampleTable wanted = wantedOf(options, model, nominal);
  if (wanted.samples.empty()) throw InsufficientData(wanted.file.string() + ": no rows, expected one per pose");
  const RealArm arm = realArm(model);
  TerminalListener listener(common);
  listener.warnings(remarksOnDrivers(model.driver_ranges, wanted.file, wanted.samples));
  const std::vector<JointCommand> commands = compensate(arm, wanted, nominal ? &*nominal : nullptr, listener.progressFunction());
  refuseUnreached(options, common, wanted, commands);
  if (nominal) warnOfLargeMoves(wanted, commands);
  writeTextFile(options.out, commandsCsv(wanted, commands));
  report(common, options, model, summaryOf(arm, wanted, commands), nominal.has_value());
  return 0;
}

constexpr const char* kExample = R"(
With --joints the real arm goes where the nominal arm of --robot would be with these joints. With --poses it goes to T_base_flange of each
row. The search begins at the columns q1, q2, ... where the table has them; otherwise at the joints of the row before.
Effects that follow dir1.., stamp, temperature, payload or another column need it in the table. Without dir1.. each joint is taken to
come straight from the row before.

Example:
  $ poecal compensate --model out/model.yaml --joints program.csv --robot capture/cobot6.urdf --out commands.csv --leave-out
  joints for 58 of 60 rows, 1 effect of the arm compensated: commands.csv
    flange off by  mean [mm]  max [mm]  mean [mrad] max [mrad]
    as meant         5.870    11.057       7.373    12.657
    compensated      0.000     0.000       0.000     0.000
as meant: with the joints of the table, as the model has it. Beyond that the tool is off by what the calibration's noise allows.
)";

}  // namespace

std::function<int()> setUpCompensate(CLI::App& app, const Common& common) {
  const auto options = std::make_shared<CompensateOptions>();
  app.add_option("--model", options->model, "model.yaml as run, diagnose or identify write it")->required()->option_text("MODEL.yaml");
  CLI::Option* poses = app.add_option("--poses", options->poses, "A table with columns x, y, z [m], qx, qy, qz, qw: T_base_flange wanted")
                           ->option_text("FILE.csv");
  app.add_option("--joints", options->joints, "A table with columns q1, q2, ...: joints that the nominal arm would be sent to")
      ->option_text("FILE.csv")
      ->excludes(poses);
  CLI::Option* robot =
      app.add_option("--robot", options->robot, "The nominal arm, robot.yaml or URDF; needed with --joints")->option_text("FILE");
  app.add_option("--base-link", options->base_link, "Of a URDF (default: as the model says)")->option_text("LINK")->needs(robot);
  app.add_option("--tip-link", options->tip_link, "Of a URDF (default: as the model says)")->option_text("LINK")->needs(robot);
  app.add_option("--out", options->out, "The table of joints to command")->required()->option_text("FILE.csv");
  app.add_flag("--leave-out", options->leave_out, "Leave out rows that cannot be reached, instead of writing nothing");
  app.footer(kExample);
  return [options, &common] { return runCompensate(*options, common); };
}

}  // namespace poecal::app
