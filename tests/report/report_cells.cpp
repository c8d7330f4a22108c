#include "report/report_cells.hpp"

#include "diagnosis/small_cell.hpp"

namespace poecal::test {
namespace {

constexpr double kPlay = 4e-4;  // [rad]

CalibrationRun calibrated(SmallCell small, bool pixels) {
  small.nominal.name = kHostileName;
  small.nominal.joints[3].name = kHostileName;
  CalibrationRun run;
  run.measurements = small.measurements();
  run.measurements.other_columns = {kHostileName};
  for (std::size_t k = 0; k < run.measurements.samples.size(); ++k) {
    Sample& sample = run.measurements.samples[k];
    sample.image = std::to_string(k) + kHostileName;
    sample.line = static_cast<int>(k) + 2;
    sample.other = {0.1 * static_cast<double>(k % 7)};
  }
  const Cell nominal{.arm = small.nominal, .camera = pixels ? small.cell.camera : std::nullopt, .registration = {}};
  run.calibration = calibrate(nominal, run.measurements);
  return run;
}

std::vector<EffectSpec> play() { return {{.effect = "joint_backlash", .location = "joint:2", .parameters = {{"half_gap", kPlay}}}}; }

}  // namespace

const CalibrationRun& runWithBacklash() {
  static const CalibrationRun run = calibrated(smallCell(11, 60, 0.1, play()), true);
  return run;
}

const CalibrationRun& runWithout() {
  static const CalibrationRun run = calibrated(smallCell(12, 60, 0.1, {}), true);
  return run;
}

const CalibrationRun& runWithCurve() {
  static const CalibrationRun run = [] {
    SmallCell small = smallCell(11, 80, 0.1,
                                {{.effect = "unknown",
                                  .location = "joint:3",
                                  .parameters = {{"low", -0.7}, {"high", 0.7}, {"c3", 4e-4}, {"c5", -4e-4}, {"c7", 4e-4}},
                                  .driver = "q3"}});
    for (CornerMeasurement& corner : small.observations[7].corners) corner.px.x() += 30.0;
    return calibrated(small, true);
  }();
  return run;
}

const CalibrationRun& runWithScatter() {
  static const CalibrationRun run =
      calibrated(smallCell(9, 80, 0.1, {{.effect = "joint_scatter", .location = "joint:2", .parameters = {{"sigma", 4e-4}}}}), true);
  return run;
}

CalibrationRun identifiedOnly() {
  CalibrationRun run = runWithBacklash();
  run.calibration.diagnosis.reset();
  run.calibration.model = run.calibration.identification->model;
  run.calibration.model_source = ModelSource::kIdentified;
  return run;
}

const CalibrationRun& runOfPoses() {
  static const CalibrationRun run = [] {
    SmallCell small = smallCell(13, 60, 0.1, {});
    measurePoses(
        small, 2, [](const Eigen::VectorXd& q) { return q(2) > 0.0 ? kPlay : -kPlay; }, 2e-5);
    return calibrated(small, false);
  }();
  return run;
}

}  // namespace poecal::test
