// poecal diagnose: where the gap lies, which effect causes it, how far it shrinks.
#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "poecal/core/error.hpp"
#include "poecal/report/report.hpp"
#include "sources.hpp"
#include "summaries.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal diagnose capture --out out
  diagnosis: 1 finding
    where: joint:6, driven by q5
    which: joint_coupling: another joint's motion leaks into this one (99.9 % sure or more)
           ratio 0.0009735 +- 4.9e-05, source 5
    how far: the gap shrinks by 72 % (43 % to 80 %)
    what to do: enter the coupling ratio of the wrist's gears in the controller
)";

}  // namespace

std::function<int()> setUpDiagnose(CLI::App& app, const Common& common) {
  struct Options {
    ArmSource source;
    std::filesystem::path out;
    std::string explain;
    CalibrateOptions calibrate;
  };
  const auto options = std::make_shared<Options>();
  options->calibrate.identify.allow_still_joints = true;
  addArmSource(app, options->source, options->calibrate.identify);
  app.add_option("--out", options->out, "Folder for diagnosis.json and model.yaml")->required();
  app.add_option("--identified", options->source.capture.identified, "Folder with the results of identify, which must be of this capture");
  app.add_option("--explain", options->explain, "An effect: say for each of its places why it was or was not chosen");
  addToleranceOptions(app, options->calibrate.identify);
  app.footer(kExample);
  return [options, &common] {
    const ArmSource& source = options->source;
    if (!options->explain.empty()) effectKind(options->explain);
    if (!source.capture.identified.empty() && source.capture.folder.empty()) throw InvalidArgument("--identified needs a CAPTURE");
    const CalibrationRun run = runSource("diagnose", source, options->out, options->calibrate, {.diagnosis = true}, common);
    writeReportData(run, source.capture.folder, options->out);
    std::string text = diagnosisSummary(run, TextLength::kWhole);
    if (!options->explain.empty() && run.calibration.diagnosis) text += explainEffect(*run.calibration.diagnosis, options->explain);
    printReport(common, text, diagnosisJson(run.calibration, run.measurements));
    return 0;
  };
}

}  // namespace poecal::app
