// poecal export: the calibrated arm of a model.yaml, put into the URDF it came from.
#include <filesystem>
#include <memory>
#include <string>
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
#include "poecal/identification/model.hpp"
#include "poecal/robot/robot_file.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

struct ExportOptions {
  std::filesystem::path model;
  std::filesystem::path urdf;
  std::filesystem::path out;
  std::string base_link;  ///< Empty: as the model says, otherwise the URDF's root.
  std::string tip_link;   ///< Empty: as the model says, otherwise the URDF's only leaf.
};

void chooseLinks(ExportOptions& options, const Model& model) {
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

void warnOfEffects(const Model& model) {
  for (const AppliedEffect& applied : model.effects) {
    warn(fmt::format("effect {} at {} stays behind: a URDF holds geometry alone", applied.effect.name(), applied.effect.location()));
  }
}

void summarise(const Common& common, const ExportOptions& options, const Arm& nominal, const Arm& calibrated) {
  std::string text = fmt::format("{}: {} joints from {} to {}\n{:20} {:>10} {:>12}\n", options.out.string(), calibrated.jointCount(),
                                 options.base_link, options.tip_link, "joint", "shift [mm]", "tilt [mrad]");
  nlohmann::json joints = nlohmann::json::array();
  for (std::size_t k = 0; k < calibrated.joints.size(); ++k) {
    const AxisOffset offset = axisOffset(nominal.joints[k], calibrated.joints[k]);
    text += fmt::format("{:20} {:>10.3f} {:>12.3f}\n", printableLine(nominal.joints[k].name), 1e3 * offset.shift, 1e3 * offset.tilt);
    joints.push_back({{"name", nominal.joints[k].name}, {"shift", offset.shift}, {"tilt", offset.tilt}});
  }
  printSummary(common, text,
               {{"urdf", options.out.string()}, {"base_link", options.base_link}, {"tip_link", options.tip_link}, {"joints", joints}});
}

int runExport(ExportOptions options, const Common& common) {
  const Model model = readModel(options.model);
  const Arm& calibrated = *model.cell.arm;
  chooseLinks(options, model);
  requireOutputs({options.out}, {options.model, options.urdf});
  warnOfEffects(model);
  const Arm nominal = readUrdf(options.urdf, options.base_link, options.tip_link);
  writeTextFile(options.out, correctedUrdf(options.urdf, options.base_link, options.tip_link, calibrated));
  summarise(common, options, nominal, calibrated);
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
)";

}  // namespace

std::function<int()> setUpExport(CLI::App& app, const Common& common) {
  const auto options = std::make_shared<ExportOptions>();
  app.add_option("model", options->model, "model.yaml as identify, diagnose or run write it")->required()->option_text("MODEL.yaml");
  app.add_option("--urdf", options->urdf, "The URDF to correct; the file itself is not changed")->required()->option_text("FILE");
  app.add_option("--out", options->out, "The corrected URDF")->required()->option_text("FILE");
  app.add_option("--base-link", options->base_link, "First link of the arm (default: as the model says, or the root)")->option_text("LINK");
  app.add_option("--tip-link", options->tip_link, "Last link, the flange (default: as the model says, or the only leaf)")
      ->option_text("LINK");
  app.footer(kExample);
  return [options, &common] { return runExport(*options, common); };
}

}  // namespace poecal::app
