// From noisy corners to commands: the tool goes where it should as nearly as the noise allows.
#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"
#include "poecal/calibration/calibrate.hpp"
#include "poecal/compensation/compensate.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

constexpr double kSigma = 0.1;  // [px]
constexpr int kPoses = 60, kUnseen = 40;

/// The true arm and what it does.
RealArm truth(const test::SmallCell& small, const std::vector<EffectSpec>& effects) {
  RealArm arm{.arm = *small.cell.arm};
  for (const EffectSpec& spec : effects) arm.effects.push_back(makeEffect(spec, small.cell));
  return arm;
}

/// Mean square distance [m^2] between where a point of the tool should be in camera and where the true cell puts it, when the commands are
/// made with a model. In camera no choice of the model's base or flange enters.
double squaredToolError(const test::SmallCell& small, const RealArm& true_arm, const Model& model, bool with_effects) {
  SampleTable wanted;
  std::vector<Eigen::Isometry3d> T_camera_wanted;
  for (std::size_t k = kPoses; k < small.samples.size(); ++k) {
    Sample sample = small.samples[k];
    T_camera_wanted.push_back(small.cell.registration.cameraTarget(forwardKinematics(small.nominal, sample.q)));
    sample.T_base_flange = model.cell.registration.baseFlange(T_camera_wanted.back());
    wanted.samples.push_back(sample);
  }
  const std::vector<JointCommand> commands =
      compensate({.arm = *model.cell.arm, .effects = with_effects ? model.effects : std::vector<AppliedEffect>{}}, wanted);
  SampleTable given = wanted;
  for (std::size_t k = 0; k < commands.size(); ++k) given.samples[k].q = commands[k].q;
  const std::vector<Eigen::Isometry3d> reached = reachedPoses(true_arm, given);
  double squares = 0.0;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const Eigen::Isometry3d T_camera_reached = small.cell.registration.cameraTarget(reached[k]);
    squares += (T_camera_reached.translation() - T_camera_wanted[k].translation()).squaredNorm() / static_cast<double>(reached.size());
  }
  return squares;
}

Model calibrated(const test::SmallCell& small, CalibrationStep last) {
  const test::SmallCell seen = small.head(kPoses);
  const Cell nominal{.arm = seen.nominal, .camera = seen.cell.camera, .registration = {}};
  return *calibrate(nominal, seen.measurements(), {.last = last}).model;
}

TEST(CompensatedCell, ToolErrorIsWhatTheNoiseAllows) {
  const std::vector<EffectSpec> effects{
      {.effect = "joint_coupling", .location = "joint:6", .parameters = {{"source", 5.0}, {"ratio", 4e-3}}},
      {.effect = "joint_backlash", .location = "joint:2", .parameters = {{"half_gap", 4e-4}}}};
  double compensated = 0.0, geometry_alone = 0.0, allowed = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const test::SmallCell flawed = test::smallCell(seed, kPoses + kUnseen, kSigma, effects);
    const Model model = calibrated(flawed, CalibrationStep::kDiagnosis);
    compensated += squaredToolError(flawed, truth(flawed, effects), model, true);
    geometry_alone += squaredToolError(flawed, truth(flawed, effects), model, false);
    // The same cell, poses and noise without the effects: what is left there is the noise of the corners, which no model takes away.
    const test::SmallCell sound = test::smallCell(seed, kPoses + kUnseen, kSigma, {});
    allowed += squaredToolError(sound, truth(sound, {}), calibrated(sound, CalibrationStep::kIdentification), true);
  }
  const auto rms = [](double sum) { return 1e3 * std::sqrt(sum / 6.0); };
  std::cout << "tool error, rms of unseen poses: " << rms(compensated) << " mm; the noise allows " << rms(allowed)
            << " mm; without the effects' compensation " << rms(geometry_alone) << " mm\n";
  EXPECT_LE(std::sqrt(compensated), 1.2 * std::sqrt(allowed));
  // These effects are well above the noise: commands that ignore them fail the line above.
  EXPECT_GE(std::sqrt(geometry_alone), 2.0 * std::sqrt(allowed));
}

}  // namespace
}  // namespace poecal
