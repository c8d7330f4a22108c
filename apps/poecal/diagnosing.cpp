#include "diagnosing.hpp"

#include <limits>

#include <fmt/format.h>

#include "core/yaml.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal::app {
namespace {

DiagnoseOptions diagnoseOptions(const IdentifyOptions& options) {
  DiagnoseOptions diagnose;
  diagnose.jobs = options.jobs;
  // Without tolerances geometry may be anything: wide ones say so and keep the search well-posed.
  constexpr double kAnywhere = 1.0;
  diagnose.tolerance_position = options.tolerance_position > 0.0 ? options.tolerance_position : kAnywhere;
  diagnose.tolerance_rotation = options.tolerance_rotation > 0.0 ? options.tolerance_rotation : kAnywhere;
  return diagnose;
}

/// To all poses, as the diagnosis holds out poses itself.
IdentifyOptions startOptions(IdentifyOptions options) {
  options.hold_out_every = 0;
  options.camera = CameraChoice::kAuto;
  options.allow_still_joints = true;
  return options;
}

Diagnosing finish(Diagnosis diagnosis, const std::vector<Sample>& samples, const std::filesystem::path& out) {
  Diagnosing result;
  const std::string report = diagnosisJson(diagnosis, samples);
  writeTextFile(out / "model.yaml", modelYaml(diagnosis.model));
  writeTextFile(out / "diagnosis.json", report);
  result.text = diagnosisText(diagnosis, samples);
  result.json = nlohmann::json::parse(report);
  result.diagnosis = std::move(diagnosis);
  return result;
}

}  // namespace

Identification diagnosisStart(const CaptureInputs& inputs, const IdentifyOptions& options, const Identification* identification) {
  const bool lens_stated = inputs.camera.standard_deviation.size() > 0;
  if (identification != nullptr && (lens_stated || !identification->free.intrinsics)) return *identification;
  return identifyInputs(inputs, startOptions(options));
}

Identification diagnosisStart(const Arm& arm, const PoseTable& table, const IdentifyOptions& options) {
  return identifyTable(arm, table, startOptions(options));
}

Diagnosing diagnoseCapture(const CaptureInputs& inputs, const Identification& start, const IdentifyOptions& options,
                           const std::filesystem::path& out) {
  const Capture& capture = inputs.capture;
  return finish(diagnose(start, inputs.observations, capture.table.samples, capture.table.other_columns, capture.target, capture.gravity,
                         diagnoseOptions(options)),
                capture.table.samples, out);
}

IdentifiedModel identifiedModel(const Identification& identification) {
  const ErrorSummary& held_out = identification.stages.back().held_out;
  return {held_out.corners > 0 ? held_out.px.rms : std::numeric_limits<double>::quiet_NaN(), modelYaml(identification.model)};
}

IdentifiedModel readIdentifiedModel(const std::filesystem::path& folder) {
  const YamlNode report = YamlNode::load(folder / "identification.json");  // JSON is YAML
  report.checkFormat("poecal-identification/1");
  const auto rms = report["residuals"]["held_out"].find("rms_px");
  return {rms ? rms->number() : std::numeric_limits<double>::quiet_NaN(), readTextFile(folder / "model.yaml")};
}

Diagnosing diagnoseIdentified(const CaptureInputs& inputs, const Identification& start, const IdentifiedModel& identified,
                              const IdentifyOptions& options, const std::filesystem::path& out) {
  constexpr double kClearly = 0.95;
  Diagnosing result;
  try {
    result = diagnoseCapture(inputs, start, options, out);
  } catch (const InsufficientData& missing) {
    result.json = {{"format", "poecal-diagnosis/1"}, {"verdict", "insufficient data"}, {"why", missing.what()}};
    writeTextFile(out / "model.yaml", identified.model_yaml);
    writeTextFile(out / "diagnosis.json", result.json.dump(2) + "\n");
    result.text = fmt::format("no diagnosis: {}\n", missing.what());
    return result;
  }
  if (identified.held_out_px > 0.0 && identified.held_out_px < kClearly * result.diagnosis.stages.back().rms) {
    writeTextFile(out / "model.yaml", identified.model_yaml);
    result.text += fmt::format("  model.yaml is the identified one, without effects: it predicts poses that it did not see to {:.3f} px\n",
                               identified.held_out_px);
  }
  return result;
}

Diagnosing diagnosePoses(const PoseTable& table, const Identification& identification, const IdentifyOptions& options,
                         const std::filesystem::path& out) {
  std::vector<Sample> samples;
  for (const MeasuredPose& pose : table.poses) samples.push_back(pose.sample);
  const DiagnoseOptions diagnose_options = diagnoseOptions(options);
  return finish(diagnose(identification, instrumentObservations(table), samples, table.other_columns, Target{}, {0.0, 0.0, -9.80665},
                         diagnose_options),
                samples, out);
}

}  // namespace poecal::app
