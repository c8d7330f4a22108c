#include "diagnosing.hpp"

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

Diagnosing diagnoseCapture(const CaptureInputs& inputs, const Identification& identification, const IdentifyOptions& options,
                           const std::filesystem::path& out) {
  const Capture& capture = inputs.capture;
  return finish(diagnose(identification, inputs.observations, capture.table.samples, capture.table.other_columns, capture.target,
                         capture.gravity, diagnoseOptions(options)),
                capture.table.samples, out);
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
