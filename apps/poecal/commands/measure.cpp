// poecal measure: hand-eye and base registration, and the flange poses that the camera measured.
#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "sources.hpp"
#include "summaries.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal measure capture --out out
  registered 60 pictures: 2.776 px rms (2.776 px with every picture, 0.002 px with a free pose for each)
    camera in base: 1.5002 0.3093 0.8945 m
)";

}  // namespace

std::function<int()> setUpMeasure(CLI::App& app, const Common& common) {
  struct Options {
    CaptureSource capture;
    std::filesystem::path out;
  };
  const auto options = std::make_shared<Options>();
  addMeasuredCaptureOption(app, options->capture)->required();
  app.add_option("--out", options->out, "Folder for registration.yaml and flange_poses.csv")->required();
  app.footer(kExample);
  return [options, &common] {
    const CalibrationRun run = runSource("measure", {options->capture, {}}, options->out, {.last = CalibrationStep::kRegistration},
                                         {.registration = true}, common);
    printReport(common, registrationText(run), registrationSummaryJson(run));
    return 0;
  };
}

}  // namespace poecal::app
