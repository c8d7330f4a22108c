// Cells of every kind, from measurements to a model that predicts poses which it did not see: the camera on the flange, a sliding joint, a
// fisheye lens, and an instrument that measures positions alone.
#include <cmath>

#include <gmock/gmock.h>

#include "calibration/true_cell.hpp"

namespace poecal {
namespace {

using ::testing::IsEmpty;

using test::kPoses;
using test::kSigma;
using test::kUnseen;
using test::TrueCell;

/// Calibrates pictures of a cell without effects and expects a model better than a single corner, and no finding.
void expectCalibrated(TrueCell truth) {
  const Measurements measurements = truth.pictures();
  const Calibration calibration = calibrate(truth.stated(), measurements);
  ASSERT_TRUE(calibration.model && calibration.diagnosis) << calibration.no_diagnosis;
  // Two thirds of a corner's noise: 240 corners tell of some thirty unknowns.
  EXPECT_LT(truth.unseen(calibration.model->cell), 0.7 * kSigma);
  EXPECT_LT(truth.unseen(calibration.model->cell), 0.2 * truth.unseen(calibration.registration->cell));
  EXPECT_THAT(calibration.diagnosis->findings, IsEmpty());
  EXPECT_THAT(calibration.warnings, IsEmpty());
}

TEST(KindsOfCell, CameraOnTheFlange) { expectCalibrated(TrueCell(51, Setup::kEyeInHand, false)); }

TEST(KindsOfCell, SlidingJoint) { expectCalibrated(TrueCell(52, Setup::kEyeToHand, true)); }

TEST(KindsOfCell, SlidingJointWithTheCameraOnTheFlange) { expectCalibrated(TrueCell(53, Setup::kEyeInHand, true)); }

TEST(KindsOfCell, FisheyeLens) {
  TrueCell truth(54, Setup::kEyeToHand, false);
  Camera& camera = *truth.cell.camera;
  camera.model = DistortionModel::kEquidistant;
  camera.fx = camera.fy = 2000.0;
  camera.distortion.resize(4);
  camera.distortion << -0.02, 0.01, -0.004, 0.001;
  expectCalibrated(truth);
}

TEST(KindsOfCell, PositionsAlone) {
  TrueCell truth(55, Setup::kEyeToHand, false);
  constexpr double kNoise = 2e-5;  // [m]
  truth.drawPoses(kPoses + kUnseen);
  Measurements measurements;
  for (int k = 0; k < kPoses; ++k) {
    Sample sample;
    sample.q = truth.q[static_cast<std::size_t>(k)];
    const Eigen::Isometry3d T = truth.cell.registration.cameraTarget(forwardKinematics(*truth.cell.arm, sample.q));
    measurements.addPosition(sample, T.translation() + kNoise * test::normalVector(truth.rng, 3), kNoise);
  }
  const Calibration calibration = calibrate({.arm = truth.nominal, .camera = {}, .registration = {}}, measurements);
  ASSERT_TRUE(calibration.model && calibration.diagnosis) << calibration.no_diagnosis;
  std::vector<double> lengths;
  for (std::size_t k = kPoses; k < truth.q.size(); ++k) {
    const auto toolOf = [&](const Cell& cell) -> Eigen::Vector3d {
      return cell.registration.cameraTarget(forwardKinematics(*cell.arm, truth.q[k])).translation();
    };
    lengths.push_back((toolOf(truth.cell) - toolOf(calibration.model->cell)).norm());
  }
  // The length of a measured point's own noise: 180 numbers tell of some twenty unknowns.
  EXPECT_LT(rms(lengths), std::sqrt(3.0) * kNoise);
  EXPECT_THAT(calibration.diagnosis->findings, IsEmpty());
}

}  // namespace
}  // namespace poecal
