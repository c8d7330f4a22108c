// poecal run: the main job from a capture folder to a calibrated arm.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "identifying.hpp"
#include "measuring.hpp"

namespace poecal::app {

std::function<int()> setUpRun(CLI::App& app, const Common& common) {
  struct Options {
    std::filesystem::path capture, out;
    IdentifyOptions identify;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("CAPTURE", options->capture, "Capture folder")->required();
  app.add_option("--out", options->out, "Folder for all results")->required();
  addIdentifyOptions(app, options->identify);
  return [options, &common] {
    const CaptureInputs inputs = loadCapture(options->capture, options->out, common);
    const Measuring measuring = measureCapture(inputs, options->out);
    nlohmann::json json{{"measure", measuring.json}};
    std::string text = measuring.text;
    if (inputs.cell.arm) {
      const Identifying identifying = identifyCapture(inputs, options->identify, options->out);
      text += identifying.text;
      json["identify"] = identifying.json;
    }
    text += "results in " + options->out.string() + "; diagnosis and report are not built yet\n";
    printSummary(common, text, json);
    return 0;
  };
}

}  // namespace poecal::app
