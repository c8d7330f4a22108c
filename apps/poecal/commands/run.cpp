// poecal run: the main job from a capture folder to a calibrated arm.
#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "poecal/report/report.hpp"
#include "sources.hpp"
#include "summaries.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal run capture --out out
  registered 60 pictures: 2.776 px rms (2.776 px with every picture, 0.002 px with a free pose for each)
    camera in base: 1.5002 0.3093 0.8945 m
  identified cobot6 by bundle from 60 poses
                calibration                               held-out poses
                px rms, mean mm and mrad of the flange
    nominal         3.067 px      3.978 mm    7.894 mrad      3.067 px      3.978 mm    7.894 mrad
    registered      2.776 px      3.540 mm    6.798 mrad      3.133 px      3.806 mm    7.070 mrad
    identified      0.112 px      0.068 mm    1.239 mrad      0.126 px      0.085 mm    1.405 mrad
    ...
  diagnosis: 1 finding
    where: joint:6, driven by q5
    which: joint_coupling: another joint's motion leaks into this one (99.9 % sure or more)
           ratio 0.001004 +- 1.8e-06, source 5
    how far: the gap shrinks by 99 % (98 % to 99 %)
    ...
  results in out, to look at: out/report.html
)";

}  // namespace

std::function<int()> setUpRun(CLI::App& app, const Common& common) {
  struct Options {
    CaptureSource capture;
    std::filesystem::path out;
    CalibrateOptions calibrate;
  };
  const auto options = std::make_shared<Options>();
  addMeasuredCaptureOption(app, options->capture)->required();
  app.add_option("--out", options->out, "Folder for all results")->required();
  addIdentifyOptions(app, options->calibrate.identify);
  app.footer(kExample);
  return [options, &common] {
    const ResultFiles all{.registration = true, .identification = true, .diagnosis = true};
    const CalibrationRun run = runSource("run", {options->capture, {}}, options->out, options->calibrate, all, common);
    const Calibration& calibration = run.calibration;
    std::string text = registrationText(run);
    std::vector<std::pair<std::string, std::string>> json{{"measure", registrationSummaryJson(run)}};
    if (calibration.identification) {
      text += identificationText(run) + diagnosisSummary(run, TextLength::kScreen);
      json.emplace_back("identify", identificationJson(*calibration.identification, run.measurements.samples));
      json.emplace_back("diagnose", diagnosisJson(calibration, run.measurements));
    }
    TerminalListener listener(common);
    const std::string no_page = writeReport(run, options->capture.folder, options->out, common.jobs, listener.progressFunction());
    const std::string out = options->out.string();
    text += no_page.empty() ? "results in " + out + ", to look at: " + (options->out / "report.html").string() + "\n"
                            : "results in " + out + ", without report.html: " + no_page + "\n";
    printReport(common, text, jsonObject(json));
    return 0;
  };
}

}  // namespace poecal::app
