// poecal diagnose: where the gap lies, which effect causes it, how far it shrinks.
#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "diagnosing.hpp"
#include "poecal/core/error.hpp"
#include "poecal/robot/robot_file.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal diagnose capture --out out
  diagnosis: 1 finding
    where: joint:6, driven by q5
    which: joint_coupling: another joint's motion leaks into this one (100 % sure)
           ratio 0.0009826 +- 5.9e-05, source 5
    how far: the gap shrinks by 67 % (53 % to 77 %)
    what to do: enter the coupling ratio of the wrist's gears in the controller
)";

}  // namespace

std::function<int()> setUpDiagnose(CLI::App& app, const Common& common) {
  struct Options {
    ArmSource source;
    std::filesystem::path out;
    std::filesystem::path identified;
    std::string explain;
    IdentifyOptions identify;
  };
  const auto options = std::make_shared<Options>();
  addArmSource(app, options->source, options->identify);
  app.add_option("--out", options->out, "Folder for diagnosis.json and model.yaml")->required();
  app.add_option(
      "--identified", options->identified,
      "Folder with the results of identify: its model.yaml is kept where it predicts unseen poses clearly better, as run does it");
  app.add_option("--explain", options->explain, "Say of an effect, at each of its places, why it was or was not chosen");
  addToleranceOptions(app, options->identify);
  app.footer(kExample);
  return [options, &common] {
    requireArmSource("diagnose", options->source);
    if (!options->explain.empty()) effectKind(options->explain);
    options->identify.jobs = common.jobs;
    Diagnosing result;
    if (!options->source.capture.folder.empty()) {
      const CaptureInputs inputs = loadCapture(options->source.capture, options->out, common);
      const Identification start = diagnosisStart(inputs, options->identify);
      result = options->identified.empty()
                   ? diagnoseCapture(inputs, start, options->identify, options->out)
                   : diagnoseIdentified(inputs, start, readIdentifiedModel(options->identified), options->identify, options->out);
    } else {
      if (!options->identified.empty()) throw InvalidArgument("--identified needs a CAPTURE");
      const Arm arm = readArm(options->source.robot, options->source.base_link, options->source.tip_link);
      const PoseTable table = readPoses(options->source.poses, arm);
      result = diagnosePoses(table, diagnosisStart(arm, table, options->identify), options->identify, options->out);
    }
    if (!options->explain.empty()) result.text += explainEffect(result.diagnosis, options->explain);
    printSummary(common, result.text, result.json);
    return 0;
  };
}

}  // namespace poecal::app
