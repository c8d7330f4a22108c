// poecal identify: the arm's twists and home pose from a capture, or from poses of any instrument.
#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "poecal/report/report.hpp"
#include "sources.hpp"
#include "summaries.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal identify capture --out out
  identified cobot6 by bundle from 60 poses
                calibration                               held-out poses
                px rms, mean mm and mrad of the flange
    nominal         2.996 px      3.717 mm    7.019 mrad      2.996 px      3.717 mm    7.019 mrad
    registered      2.776 px      3.535 mm    7.007 mrad      3.124 px      3.796 mm    7.295 mrad
    identified      0.004 px      0.001 mm    0.012 mrad      0.005 px      0.001 mm    0.020 mrad
)";

}  // namespace

std::function<int()> setUpIdentify(CLI::App& app, const Common& common) {
  struct Options {
    ArmSource source;
    std::filesystem::path out;
    CalibrateOptions calibrate{.last = CalibrationStep::kIdentification};
  };
  const auto options = std::make_shared<Options>();
  addArmSource(app, options->source, options->calibrate.identify);
  app.add_option("--out", options->out, "Folder for model.yaml and identification.json")->required();
  addIdentifyOptions(app, options->calibrate.identify);
  app.footer(kExample);
  return [options, &common] {
    const CalibrationRun run = runSource("identify", options->source, options->out, options->calibrate, {.identification = true}, common);
    writeReportData(run, options->source.capture.folder, options->out);
    printReport(common, identificationText(run), identificationJson(*run.calibration.identification, run.measurements.samples));
    return 0;
  };
}

}  // namespace poecal::app
