// poecal measure: hand-eye and base registration, and the flange poses that the camera measured.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "measuring.hpp"

namespace poecal::app {

std::function<int()> setUpMeasure(CLI::App& app, const Common& common) {
  struct Options {
    std::filesystem::path capture, out;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("CAPTURE", options->capture, "Capture folder")->required();
  app.add_option("--out", options->out, "Folder for registration.yaml and flange_poses.csv")->required();
  return [options, &common] {
    const CaptureInputs inputs = loadCapture(options->capture, options->out, common);
    const Measuring measuring = measureCapture(inputs, options->out);
    printSummary(common, measuring.text, measuring.json);
    return 0;
  };
}

}  // namespace poecal::app
