// poecal export: a model.yaml as other programs take it: a URDF, ROS, tables for controllers.
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/printable.hpp"
#include "poecal/core/text.hpp"
#include "poecal/exporting/dh.hpp"
#include "poecal/exporting/for_ros.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/robot/robot_file.hpp"
#include "sources.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

struct ExportOptions {
  std::filesystem::path model;
  std::filesystem::path urdf;
  std::filesystem::path robot;  ///< The nominal arm where there is no URDF.
  std::filesystem::path out, camera_info, transforms, joint_table, dh;
  std::string base_link;  ///< Empty: as the model says, otherwise the URDF's root.
  std::string tip_link;   ///< Empty: as the model says, otherwise the URDF's only leaf.
};

void chooseLinks(ExportOptions& options, const Model& model) {
  requireLinksOf(model, options.urdf, options.base_link, options.tip_link);
  if (options.base_link.empty()) options.base_link = model.base_link;
  if (options.tip_link.empty()) options.tip_link = model.tip_link;
  if (!options.base_link.empty() && !options.tip_link.empty()) return;
  const UrdfEnds ends = urdfEnds(options.urdf);
  if (options.base_link.empty()) options.base_link = ends.root;
  if (!options.tip_link.empty()) return;
  if (ends.leaves.size() != 1) {
    throw InvalidArgument(
        fmt::format("{} has {} chains, expected --tip-link to name the end of the arm, one of their ends ({}) or a link before",
                    options.urdf.string(), ends.leaves.size(), fmt::join(ends.leaves, ", ")));
  }
  options.tip_link = ends.leaves.front();
}

void warnOfEffects(const ExportOptions& options, const Model& model) {
  if (options.out.empty()) return;
  for (const AppliedEffect& applied : model.effects) {
    warn(fmt::format("effect {} at {} stays behind: a URDF holds geometry alone", applied.effect.name(), applied.effect.location()));
  }
}

/// What is to be written, and what is said of it.
struct Writing {
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  std::string text;
  nlohmann::json json = nlohmann::json::object();

  void add(const char* key, const std::filesystem::path& file, const std::string& content, const std::string& what) {
    files.emplace_back(file, content);
    text += fmt::format("{}: {}\n", file.string(), what);
    json[key] = file.string();
  }
};

void sayAxes(const ExportOptions& options, const Arm& nominal, const Arm& calibrated, Writing& writing) {
  writing.text += fmt::format("{:20} {:>10} {:>12}\n", "joint", "shift [mm]", "tilt [mrad]");
  nlohmann::json joints = nlohmann::json::array();
  for (std::size_t k = 0; k < calibrated.joints.size(); ++k) {
    const AxisOffset offset = axisOffset(nominal.joints[k], calibrated.joints[k]);
    writing.text +=
        fmt::format("{:20} {:>10.3f} {:>12.3f}\n", printableLine(nominal.joints[k].name), 1e3 * offset.shift, 1e3 * offset.tilt);
    joints.push_back({{"name", nominal.joints[k].name}, {"shift", offset.shift}, {"tilt", offset.tilt}});
  }
  writing.json["base_link"] = options.base_link;
  writing.json["tip_link"] = options.tip_link;
  writing.json["joints"] = joints;
}

/// What needs the nominal arm beside the model.
void exportArm(ExportOptions& options, const Model& model, Writing& writing) {
  const Arm& calibrated = *model.cell.arm;
  if (!options.urdf.empty()) chooseLinks(options, model);
  const Arm nominal = options.urdf.empty() ? readRobotYaml(options.robot) : readUrdf(options.urdf, options.base_link, options.tip_link);
  requireArmOf(model, options.model, nominal, options.urdf.empty() ? options.robot : options.urdf);
  if (!options.joint_table.empty()) {
    writing.add("joint_table", options.joint_table, jointTableCsv(model, nominal), fmt::format("{} joints", calibrated.jointCount()));
  }
  if (!options.dh.empty()) {
    const DhTables tables = dhTables(nominal, calibrated);
    writing.add("dh", options.dh, dhYaml(tables, calibrated),
                tables.nominal.plain() ? "the nominal arm is DH-like: rows alone describe it"
                                       : "the nominal arm is not DH-like: its rows need the base and tool of the file");
  }
  if (options.out.empty()) return;
  writing.add("urdf", options.out, correctedUrdf(options.urdf, options.base_link, options.tip_link, calibrated),
              fmt::format("{} joints from {} to {}", calibrated.jointCount(), options.base_link, options.tip_link));
  sayAxes(options, nominal, calibrated, writing);
}

void checkOptions(const ExportOptions& options) {
  const bool arm = !options.out.empty() || !options.joint_table.empty() || !options.dh.empty();
  if (!arm && options.camera_info.empty() && options.transforms.empty()) {
    throw InvalidArgument("export needs a file to write: --out, --camera-info, --transforms, --joint-table or --dh");
  }
  if (!options.out.empty() && options.urdf.empty()) throw InvalidArgument("--out needs --urdf, the URDF to correct");
  if (arm && options.urdf.empty() == options.robot.empty()) {
    throw InvalidArgument("--joint-table and --dh need the nominal arm: --urdf, or --robot where it is a robot.yaml");
  }
}

int runExport(ExportOptions options, const Common& common) {
  checkOptions(options);
  const Model model = readModel(options.model);
  std::vector<std::filesystem::path> outputs;
  for (const auto& file : {options.out, options.camera_info, options.transforms, options.joint_table, options.dh}) {
    if (!file.empty()) outputs.push_back(file);
  }
  requireOutputs(outputs, {options.model, options.urdf, options.robot});
  Writing writing;
  if (!options.urdf.empty() || !options.robot.empty()) {
    warnOfEffects(options, model);
    exportArm(options, model, writing);
  }
  if (!options.camera_info.empty()) writing.add("camera_info", options.camera_info, cameraInfoYaml(model), "the lens");
  if (!options.transforms.empty()) {
    writing.add("transforms", options.transforms, transformsYaml(model, frameNames(model)), "where camera and target are");
  }
  // Nothing before all of it is there.
  for (const auto& [file, content] : writing.files) writeTextFile(file, content);
  printSummary(common, writing.text, writing.json);
  return 0;
}

constexpr const char* kExample = R"(
Example:
  $ poecal export out/model.yaml --urdf capture/cobot6.urdf --out calibrated.urdf
  calibrated.urdf: 6 joints from base_link to flange
  joint                shift [mm]  tilt [mrad]
  shoulder_pan              0.335        4.268
  shoulder_lift             0.583        1.306
  elbow                     0.571        1.399
  wrist_1_joint             0.790        2.605
  wrist_2_joint             0.675        1.151
  wrist_3_joint             0.758        1.367
shift: from the old origin to the new axis; tilt: between old and new axis.
For ROS, add --camera-info camera_info.yaml --transforms transforms.yaml; for a controller --dh dh.yaml --joint-table joints.csv.
)";

}  // namespace

std::function<int()> setUpExport(CLI::App& app, const Common& common) {
  const auto options = std::make_shared<ExportOptions>();
  app.add_option("model", options->model, "model.yaml as identify, diagnose or run write it")->required()->option_text("MODEL.yaml");
  app.add_option("--urdf", options->urdf, "The nominal URDF, to correct with --out; the file itself is not changed")->option_text("FILE");
  app.add_option("--robot", options->robot, "The nominal arm where it is a robot.yaml, for --joint-table and --dh")->option_text("FILE");
  app.add_option("--out", options->out, "The corrected URDF")->option_text("FILE");
  app.add_option("--camera-info", options->camera_info, "The lens as ROS's camera_info")->option_text("FILE.yaml");
  app.add_option("--transforms", options->transforms, "Where camera and target are, both ways, as static transforms for tf2")
      ->option_text("FILE.yaml");
  app.add_option("--joint-table", options->joint_table, "A row per joint: zero, axis, and what it does beyond geometry")
      ->option_text("FILE.csv");
  app.add_option("--dh", options->dh, "Corrected DH parameters, with Hayati's beta at parallel axes")->option_text("FILE.yaml");
  app.add_option("--base-link", options->base_link, "First link of the arm (default: as the model says, or the root)")->option_text("LINK");
  app.add_option("--tip-link", options->tip_link, "Last link, the flange (default: as the model says, or the only leaf)")
      ->option_text("LINK");
  app.footer(kExample);
  return [options, &common] { return runExport(*options, common); };
}

}  // namespace poecal::app
