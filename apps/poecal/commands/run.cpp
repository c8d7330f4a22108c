// poecal run: the main job from a capture folder to a calibrated arm.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "diagnosing.hpp"
#include "measuring.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal run capture --out out
  registered 60 pictures: 2.776 px rms (2.776 px with every picture, 0.002 px with a free pose for each)
    camera in base: 1.5001 0.3095 0.8944 m
  identified cobot6 by bundle from 60 poses
                calibration                               poses that the fit did not see
                px rms, mean mm and mrad at the flange
    nominal         3.042 px      3.660 mm    6.218 mrad      3.042 px      3.660 mm    6.218 mrad
    registered      2.776 px      3.539 mm    6.911 mrad      3.125 px      3.809 mm    7.200 mrad
    identified      0.004 px      0.037 mm    0.084 mrad      0.005 px      0.046 mm    0.085 mrad
  diagnosis: nothing beyond noise and geometry
  results in out; the report is not built yet
)";

}  // namespace

std::function<int()> setUpRun(CLI::App& app, const Common& common) {
  struct Options {
    CaptureSource capture;
    std::filesystem::path out;
    IdentifyOptions identify;
  };
  const auto options = std::make_shared<Options>();
  addMeasuredCaptureOption(app, options->capture)->required();
  app.add_option("--out", options->out, "Folder for all results")->required();
  addIdentifyOptions(app, options->identify);
  app.footer(kExample);
  return [options, &common] {
    options->identify.jobs = common.jobs;
    const CaptureInputs inputs = loadCapture(options->capture, options->out, common);
    const Measuring measuring = measureCapture(inputs, options->out);
    nlohmann::json json{{"measure", measuring.json}};
    std::string text = measuring.text;
    if (inputs.cell.arm) {
      const Identifying identifying = identifyCapture(inputs, options->identify, options->out, &measuring.registration);
      text += identifying.text;
      json["identify"] = identifying.json;
      const Identification& identification = identifying.identification;
      if (identification.method == Method::kBundle) {
        const Diagnosing diagnosing = diagnoseIdentified(inputs, diagnosisStart(inputs, options->identify, &identification),
                                                         identifiedModel(identification), options->identify, options->out);
        text += diagnosing.text;
        json["diagnose"] = diagnosing.json;
      } else {
        text += "no diagnosis: it starts from method bundle\n";
      }
    }
    text += "results in " + options->out.string() + "; the report is not built yet\n";
    printSummary(common, text, json);
    return 0;
  };
}

}  // namespace poecal::app
