// poecal run: the main job from a capture folder to a calibrated arm.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "diagnosing.hpp"
#include "measuring.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal run capture --out out
  registered 60 pictures: 2.764 px rms (2.764 px with every picture, 0.039 px with a free pose for each)
    camera in base: 1.5103 0.3125 0.8966 m
  identified cobot6 by bundle from 60 poses
                calibration                               held-out poses
                px rms, mean mm and mrad at the flange
    nominal         2.885 px     11.391 mm    7.472 mrad      4.010 px     11.752 mm    9.347 mrad
    registered      2.517 px     12.418 mm    8.708 mrad      3.744 px     12.813 mm    8.934 mrad
    identified      0.053 px      0.594 mm    1.007 mrad      0.076 px      0.744 mm    1.773 mrad
  diagnosis: nothing beyond noise and geometry
  results in out; the report is not built yet
)";

/// model.yaml is the diagnosis' with its effects, unless the identification alone predicts unseen poses clearly better: where it re-fitted
/// a lens that no single effect mends, or where what is left is of a shape that no model file can hold.
void keepTheBetterModel(const Identification& identification, const Diagnosis& diagnosis, const std::filesystem::path& out,
                        std::string& text) {
  constexpr double kClearly = 0.95;
  const double identified = identification.stages.back().held_out.px.rms, diagnosed = diagnosis.stages.back().rms;
  if (!(identified > 0.0) || !(identified < kClearly * diagnosed)) return;
  writeTextFile(out / "model.yaml", modelYaml(identification.model));
  text +=
      fmt::format("  model.yaml is the identified one, without effects: it predicts poses that it did not see to {:.3f} px\n", identified);
}

/// A capture that is too small for a diagnosis is calibrated all the same.
void diagnoseOrSayWhyNot(const CaptureInputs& inputs, const Identification& identification, const IdentifyOptions& options,
                         const std::filesystem::path& out, std::string& text, nlohmann::json& json) {
  if (identification.method != Method::kBundle) {
    text += "no diagnosis: it starts from method bundle\n";
    return;
  }
  try {
    const Diagnosing diagnosing = diagnoseCapture(inputs, identification, options, out);
    text += diagnosing.text;
    json["diagnose"] = diagnosing.json;
    keepTheBetterModel(identification, diagnosing.diagnosis, out, text);
  } catch (const InsufficientData& missing) {
    text += fmt::format("no diagnosis: {}\n", missing.what());
  }
}

}  // namespace

std::function<int()> setUpRun(CLI::App& app, const Common& common) {
  struct Options {
    std::filesystem::path capture, out;
    IdentifyOptions identify;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("CAPTURE", options->capture, "Capture folder")->required();
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
      diagnoseOrSayWhyNot(inputs, identifying.identification, options->identify, options->out, text, json);
    }
    text += "results in " + options->out.string() + "; the report is not built yet\n";
    printSummary(common, text, json);
    return 0;
  };
}

}  // namespace poecal::app
