#include "poecal/registration/registration.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/detection/detect_capture.hpp"
#include "poecal/registration/target_pose.hpp"
#include "support/cameras.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

Cell cellOf(Setup setup) {
  Cell cell;
  cell.camera = test::plumbBob(1280, 960, {1400.0, 1400.0}, {640.0, 480.0});
  cell.registration.setup = setup;
  return cell;
}

struct Registered {
  Cell truth;
  std::vector<Observation> observations;
};

/// Controller poses that show a target of one 60 mm tag about 1 m before the camera, nearly facing it, so that its second pose is close at
/// hand.
Registered registered(Rng& rng, Setup setup, int pictures, double sigma_px, double tilt = 0.5) {
  Registered data;
  data.truth = cellOf(setup);
  Registration& registration = data.truth.registration;
  registration.T_camera_near = test::randomPose(rng, 1.0, 1.0);
  registration.T_far_target = test::randomPose(rng, 1.0, 0.2);
  const Eigen::Matrix<double, 3, 4> corners = tagCorners(0.06);
  for (int k = 0; k < pictures; ++k) {
    Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
    T_camera_target.linear() =
        expSo3({0.0, 0.0, rng.uniform(-2.0, 2.0)}) * expSo3({rng.uniform(-tilt, tilt), rng.uniform(-tilt, tilt), 0.0});
    T_camera_target.translation() << rng.uniform(-0.25, 0.25), rng.uniform(-0.2, 0.2), rng.uniform(0.9, 1.1);
    Observation observation;
    observation.sample = static_cast<std::size_t>(k);
    observation.T_base_flange = registration.baseFlange(T_camera_target);
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector2d px = project(*data.truth.camera, T_camera_target * corners.col(corner)).value();
      observation.corners.push_back({{3, corner}, corners.col(corner), px + sigma_px * Eigen::Vector2d(rng.normal(), rng.normal()), 1.0});
    }
    data.observations.push_back(std::move(observation));
  }
  return data;
}

class RegistrationOf : public ::testing::TestWithParam<Setup> {};

TEST_P(RegistrationOf, WithoutNoiseIsExact) {
  Rng rng = test::rngOfThisTest();
  const Registered data = registered(rng, GetParam(), 12, 0.0);
  const RegistrationResult result = registerCell(cellOf(GetParam()), data.observations, {});
  EXPECT_LT(result.rms_px, 1e-7);
  EXPECT_THAT(result.cell.registration.T_camera_near, test::PoseIsNear(data.truth.registration.T_camera_near, 1e-9));
  EXPECT_THAT(result.cell.registration.T_far_target, test::PoseIsNear(data.truth.registration.T_far_target, 1e-9));
}

TEST_P(RegistrationOf, FlatViewsAreNotTakenForTheirMirrorPoses) {
  Rng rng = test::rngOfThisTest();
  // At 0.5 px a 60 mm tag tilted by less than 10 degrees is as well explained by the mirrored tilt, for about every other picture.
  const Registered data = registered(rng, GetParam(), 40, 0.5, 0.17);
  int flipped = 0;
  for (const Observation& observation : data.observations) {
    const Eigen::Isometry3d T_true = data.truth.registration.cameraTarget(*observation.T_base_flange);
    flipped +=
        rotationAngle(T_true.linear().transpose() * targetPoses(*data.truth.camera, observation).front().T_camera_target.linear()) > 0.1;
  }
  ASSERT_GT(flipped, 3) << "the data must hold the trap";
  const RegistrationResult result = registerCell(cellOf(GetParam()), data.observations, {});
  EXPECT_NEAR(result.rms_px, 0.5 * std::sqrt(2.0), 0.1);
  for (const RegisteredSample& sample : result.samples) EXPECT_FALSE(sample.left_out) << sample.sample;
}

TEST_P(RegistrationOf, MeasuredFlangePosesErrAsTheirCovarianceSays) {
  Rng rng = test::rngOfThisTest();
  // Little noise: in hand a tilt of the tag swings the flange on a lever of a metre, and the covariance is its first order.
  constexpr double kSigma = 0.01;
  const Registered data = registered(rng, GetParam(), 150, kSigma);
  const RegistrationResult result = registerCell(cellOf(GetParam()), data.observations, {});
  EXPECT_NEAR(result.corner_sigma_px, kSigma, 4.0 * kSigma / std::sqrt(2.0 * 2 * 150));
  double sum = 0.0;
  for (std::size_t k = 0; k < data.observations.size(); ++k) {
    const RegisteredSample& sample = result.samples[k];
    const Vector6d e = poseDifference(sample.T_base_flange, *data.observations[k].T_base_flange);
    sum += e.dot(sample.covariance.ldlt().solve(e));
  }
  // 150 poses of six numbers; sigma is estimated from 300 numbers (+-4 %, so +-8 % of the sum at one sigma).
  EXPECT_NEAR(sum / (6.0 * 150), 1.0, 0.25);
}

TEST_P(RegistrationOf, OnePictureThatContradictsTheOthersIsNamed) {
  Rng rng = test::rngOfThisTest();
  Registered data = registered(rng, GetParam(), 10, 0.3);
  data.observations[6].T_base_flange =
      *data.observations[6].T_base_flange * expSe3((Vector6d() << 0.004, -0.003, 0.004, 0.002, 0.002, -0.002).finished());
  const RegistrationResult result = registerCell(cellOf(GetParam()), data.observations, {});
  for (const RegisteredSample& sample : result.samples) EXPECT_EQ(sample.left_out, sample.sample == 6) << sample.sample;
}

TEST_P(RegistrationOf, OfManyPicturesIsTheMinimumOverAllOfThem) {
  Rng rng = test::rngOfThisTest();
  // More than hypotheses are compared on.
  const Registered data = registered(rng, GetParam(), 700, 0.3);
  const RegistrationResult result = registerCell(cellOf(GetParam()), data.observations, {});
  AdjustmentOptions options;
  options.free = {.near = true, .far = true};
  const Adjustment from_truth = adjust(data.truth, data.observations, options);
  // Both stop within 1e-6 standard deviations (some 1e-4 rad and m) of the minimum.
  constexpr double kSettled = 1e-9;
  EXPECT_THAT(result.cell.registration.T_camera_near, test::PoseIsNear(from_truth.cell.registration.T_camera_near, kSettled));
  EXPECT_THAT(result.cell.registration.T_far_target, test::PoseIsNear(from_truth.cell.registration.T_far_target, kSettled));
}

INSTANTIATE_TEST_SUITE_P(Setups, RegistrationOf, ::testing::Values(Setup::kEyeToHand, Setup::kEyeInHand),
                         [](const auto& setup) { return std::string(setupName(setup.param)); });

TEST(Registration, MirroredCornersAreSuspected) {
  Rng rng = test::rngOfThisTest();
  Registered data = registered(rng, Setup::kEyeToHand, 10, 0.1);
  for (Observation& observation : data.observations) {
    for (CornerMeasurement& corner : observation.corners) corner.px.x() = 1279.0 - corner.px.x();
  }
  EXPECT_THAT([&] { registerCell(cellOf(Setup::kEyeToHand), data.observations, {}); },
              ::testing::ThrowsMessage<ImplausibleInput>(::testing::HasSubstr("flipped (mirrored) tag")));
}

TEST(Registration, TheOtherSetupIsSuspected) {
  Rng rng = test::rngOfThisTest();
  const Registered data = registered(rng, Setup::kEyeInHand, 15, 0.1);
  EXPECT_THAT([&] { registerCell(cellOf(Setup::kEyeToHand), data.observations, {}); },
              ::testing::ThrowsMessage<ImplausibleInput>(::testing::HasSubstr("looks like setup: eye_in_hand")));
}

TEST(Registration, TooFewPicturesAndNoTurningAreSaid) {
  Rng rng = test::rngOfThisTest();
  const Registered data = registered(rng, Setup::kEyeToHand, 2, 0.1);
  EXPECT_THAT([&] { registerCell(cellOf(Setup::kEyeToHand), data.observations, {}); },
              ::testing::ThrowsMessage<InsufficientData>(::testing::HasSubstr("in 2 pictures of different poses, at least 3")));
}

RegistrationResult registerReal(const std::string& set) {
  const Capture capture = readCapture(test::realFolder() / set);
  const Detections detections = detectCapture(capture, {}).detections;
  Cell cell;
  cell.camera = capture.camera;
  cell.registration.setup = capture.setup;
  return registerCell(cell, cornerObservations(capture.table, detections, capture.target), {});
}

TEST(RegistrationReal, PandaNamesTheBadPictureAndBeatsThePublishedResult) {
  POECAL_REQUIRE_REAL("panda-apriltag");
  const RegistrationResult result = registerReal("panda-apriltag");
  EXPECT_LE(result.rms_px, 2.78);      // a plain fit without the eighth picture
  EXPECT_LE(result.rms_all_px, 4.66);  // and with it
  EXPECT_TRUE(result.samples[7].left_out);
  const auto left_out =
      std::count_if(result.samples.begin(), result.samples.end(), [](const RegisteredSample& sample) { return sample.left_out; });
  EXPECT_LE(left_out, 2);  // the fourth is the next worst
}

TEST(RegistrationReal, Fr3ReachesTheLeastSquaresOfItsCorners) {
  POECAL_REQUIRE_REAL("fr3-charuco");
  const RegistrationResult result = registerReal("fr3-charuco");
  EXPECT_LE(result.rms_px, 1.15);
  // With every picture 1.15 was reached on OpenCV 4.6's corners, which lie half a pixel beside ours in both axes.
  EXPECT_LE(result.rms_all_px, 1.16);
}

}  // namespace
}  // namespace poecal
