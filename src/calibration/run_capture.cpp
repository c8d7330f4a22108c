#include "poecal/calibration/run_capture.hpp"

#include <fmt/format.h>

#include "calibration/identified_folder.hpp"
#include "calibration/kept_result.hpp"
#include "calibration/row_contradictions.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/cell/known_registration.hpp"
#include "poecal/core/error.hpp"
#include "poecal/registration/implausible.hpp"
#include "poecal/robot/robot_file.hpp"

namespace poecal {
namespace {

/// calibrate(), whose suspicions are then about a file of `source`.
template <typename Source>
Calibration calibrateFrom(const Source& source, const Cell& nominal, const Measurements& measurements, const CalibrateOptions& options,
                          Listener& listener) {
  CalibrateOptions told = options;
  if (!told.progress) told.progress = listener.progressFunction();
  try {
    return calibrate(nominal, measurements, told);
  } catch (const ImplausibleInput& suspicion) {
    throw fileErrorOf(suspicion, source);
  }
}

/// Where the arm came from, so that `export` need not be told.
void nameUrdf(const std::filesystem::path& robot, const std::string& base_link, const std::string& tip_link, Calibration& calibration) {
  if (base_link.empty() || !calibration.model) return;
  calibration.model->urdf = robot.filename().string();
  calibration.model->base_link = base_link;
  calibration.model->tip_link = tip_link;
}

void requireJoints(const Capture& capture, const ResultFiles& files) {
  if (capture.table.has_joints || files.registration || !(files.identification || files.diagnosis)) return;
  throw InsufficientData(fmt::format("{} has no joint readings (columns q1, q2, ...): only registration is possible (poecal measure)",
                                     capture.table.file.string()));
}

}  // namespace

CalibrationRun runCapture(const CaptureSource& source, const std::filesystem::path& out, const CalibrateOptions& options,
                          const ResultFiles& files, Listener& listener) {
  LoadedCapture loaded = loadCapture(source, out, options.jobs, listener);
  const Capture& capture = loaded.capture;
  requireJoints(capture, files);
  CalibrationRun run;
  run.calibration = calibrateFrom(capture, loaded.nominal, loaded.measurements, options, listener);
  // What a calibration finds wrong it can name better.
  if (capture.arm) listener.warnings(compareFlangePoses(*capture.arm, capture.table));
  run.measurements = std::move(loaded.measurements);
  if (!source.identified.empty()) requireIdentified(source.identified, run.calibration, run.measurements);
  nameUrdf(capture.robot_file, capture.base_link, capture.tip_link, run.calibration);
  listener.warnings(run.calibration.warnings);
  writeResults(run.calibration, run.measurements, files, out);
  return run;
}

CalibrationRun runPoses(const PosesSource& source, const std::filesystem::path& out, const CalibrateOptions& options,
                        const ResultFiles& files, Listener& listener) {
  const std::vector<std::filesystem::path> results{out / "model.yaml", out / "identification.json", out / "diagnosis.json"};
  std::vector<std::filesystem::path> inputs{source.robot, source.poses};
  if (!source.registration.empty()) inputs.push_back(source.registration);
  requireOutputs(results, inputs);
  requireOutputs(reportFiles(out), inputs);
  const ResultRecord record(out, results, listener);
  Cell nominal;
  nominal.arm = readArm(source.robot, source.base_link, source.tip_link);
  if (!source.registration.empty()) readKnownRegistration(source.registration, nominal.registration);
  CalibrationRun run;
  const PoseTable table = readPoses(source.poses, *nominal.arm);
  run.measurements = measurementsOf(table);
  listener.warnings(remarksOnRows(table.file, run.measurements.samples, &*nominal.arm));
  run.calibration = calibrateFrom(table, nominal, run.measurements, options, listener);
  listener.warnings(run.calibration.warnings);
  writeResults(run.calibration, run.measurements, files, out);
  return run;
}

}  // namespace poecal
