// Transforms that are known before anything is measured.
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>

#include "calibration/true_cell.hpp"
#include "poecal/cell/known_registration.hpp"
#include "poecal/core/error.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

KnownTransform fixedAt(const Eigen::Isometry3d& T) { return {.T = T}; }

TEST(KnownRegistration, AFixedTransformIsKept) {
  test::TrueCell truth(61, Setup::kEyeToHand, false);
  const Measurements measurements = truth.pictures();
  Cell stated = truth.stated();
  stated.registration.known_near = fixedAt(truth.cell.registration.T_camera_near);
  const Calibration calibration = calibrate(stated, measurements);
  ASSERT_TRUE(calibration.model && calibration.diagnosis) << calibration.no_diagnosis;
  // Ten times the deviation that a fixed transform has.
  EXPECT_TRUE(
      calibration.model->cell.registration.T_camera_near.isApprox(truth.cell.registration.T_camera_near, 10.0 * KnownTransform::kFixed));
  EXPECT_LT(truth.unseen(calibration.model->cell), 0.7 * test::kSigma);
  EXPECT_THAT(calibration.diagnosis->findings, IsEmpty());
  EXPECT_THAT(calibration.warnings, IsEmpty());
}

// What is known without bound is not known; what is known to 0.1 um is held.
TEST(KnownRegistration, BothLimits) {
  test::TrueCell truth(62, Setup::kEyeInHand, false);
  const Measurements measurements = truth.pictures();
  Cell start = truth.cell;
  start.arm = truth.nominal;
  AdjustmentOptions options;
  options.free = {.twists = true, .near = true, .far = true};
  options.twists = TwistPrior(truth.nominal, 1e-3, 3e-3);
  const Adjustment free = adjust(start, measurements.observations, options);
  Cell wide = start;
  wide.registration.known_near = {.T = start.registration.T_camera_near, .sigma = Vector6d::Constant(1e3)};
  const Adjustment known_widely = adjust(wide, measurements.observations, options);
  // The zero of a joint may stand for a turn of the transform, so that what is compared is what both say of the pictures.
  EXPECT_NEAR(known_widely.chi_square, free.chi_square, 1e-9 * free.chi_square);
  Cell fixed = start;
  fixed.registration.known_near = fixedAt(start.registration.T_camera_near);
  const Adjustment kept = adjust(fixed, measurements.observations, options);
  options.free.near = false;
  const Adjustment held = adjust(start, measurements.observations, options);
  EXPECT_NEAR(kept.chi_square, held.chi_square, 1e-4 * held.chi_square);
  EXPECT_TRUE(kept.cell.registration.T_far_target.isApprox(held.cell.registration.T_far_target, 1e-5));
  EXPECT_FALSE(free.cell.registration.T_far_target.isApprox(held.cell.registration.T_far_target, 1e-5)) << "holding it makes no difference";
}

/// Three sliding joints: the tool keeps its orientation.
test::TrueCell gantry() {
  test::TrueCell truth(63, Setup::kEyeToHand, false);
  truth.nominal.joints = {Joint::prismatic("x", Eigen::Vector3d::UnitX(), {0.0, 0.0, 0.0}),
                          Joint::prismatic("y", Eigen::Vector3d::UnitY(), {0.0, 0.0, 0.0}),
                          Joint::prismatic("z", Eigen::Vector3d::UnitZ(), {0.0, 0.0, 0.0})};
  Eigen::VectorXd beta(twistParameterCount(truth.nominal));
  for (double& tilt : beta) tilt = 1.5e-3 * truth.rng.normal();
  truth.cell.arm = displaceTwists(truth.nominal, beta);
  return truth;
}

TEST(KnownRegistration, ServesAGantryThatNeverTurnsItsTool) {
  test::TrueCell truth = gantry();
  const Measurements measurements = truth.pictures();
  EXPECT_THROW(calibrate(truth.stated(), measurements), InsufficientData);
  Cell stated = truth.stated();
  stated.registration.known_near = fixedAt(truth.cell.registration.T_camera_near);
  stated.registration.known_far = fixedAt(truth.cell.registration.T_far_target);
  const Calibration calibration = calibrate(stated, measurements);
  ASSERT_TRUE(calibration.model);
  EXPECT_LT(truth.unseen(calibration.model->cell), 0.5 * test::kSigma);
  Cell nominal = truth.cell;
  nominal.arm = truth.nominal;
  EXPECT_GT(truth.unseen(nominal), test::kSigma) << "nothing had to be identified";
}

TEST(KnownRegistration, ATransformThatThePicturesContradictIsTold) {
  test::TrueCell truth(64, Setup::kEyeToHand, false);
  const Measurements measurements = truth.pictures();
  Cell stated = truth.stated();
  Eigen::Isometry3d elsewhere = truth.cell.registration.T_camera_near;
  elsewhere.translation().x() += 0.2;
  stated.registration.known_near = {.T = elsewhere, .sigma = Vector6d::Constant(1e-3)};
  CalibrateOptions options;
  options.last = CalibrationStep::kRegistration;
  try {
    calibrate(stated, measurements, options);
    ADD_FAILURE() << "20 cm pass in silence";
  } catch (const ImplausibleInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("T_camera_base is stated"));
  }
}

/// What is said of a cell whose transforms are known wrongly, or nothing.
std::string saidOf(const Cell& stated, const Measurements& measurements) {
  try {
    const Calibration calibration = calibrate(stated, measurements, {.last = CalibrationStep::kRegistration});
    std::string warnings;
    for (const std::string& warning : calibration.warnings) warnings += warning + "\n";
    return warnings;
  } catch (const ImplausibleInput& error) {
    return error.what();
  }
}

// A calliper that slipped: within what a nominal arm shifts a registration by, but not within what it costs.
TEST(KnownRegistration, AFewCentimetresAreToldToo) {
  test::TrueCell truth(66, Setup::kEyeToHand, false);
  const Measurements measurements = truth.pictures();
  const auto aside = [](double metres) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().y() = metres;
    return T;
  };
  for (const double metres : {0.03, 0.05}) {
    Cell stated = truth.stated();
    stated.registration.known_far = fixedAt(truth.cell.registration.T_far_target * aside(metres));
    EXPECT_THAT(saidOf(stated, measurements), HasSubstr("T_flange_target is stated")) << metres;
  }
}

TEST(KnownRegistration, ABeliefThatThePosesOverruleIsTold) {
  test::TrueCell truth(67, Setup::kEyeToHand, false);
  const Measurements measurements = truth.pictures();
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(5e-3);
  Cell stated = truth.stated();
  Eigen::Isometry3d turned = truth.cell.registration.T_far_target;
  stated.registration.known_far = {.T = turned, .sigma = sigma};
  EXPECT_THAT(saidOf(stated, measurements), Not(HasSubstr("is stated")));
  turned.rotate(Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitX()));
  stated.registration.known_far = {.T = turned, .sigma = sigma};
  EXPECT_THAT(saidOf(stated, measurements), HasSubstr("T_flange_target is stated"));
}

TEST(KnownRegistration, OfTwoTheWrongOneIsToldAndNoJointIsBlamed) {
  Eigen::Isometry3d aside = Eigen::Isometry3d::Identity();
  aside.translation().y() = 0.3;
  for (const bool turns : {true, false}) {
    test::TrueCell truth = turns ? test::TrueCell(65, Setup::kEyeToHand, false) : gantry();
    const Measurements measurements = truth.pictures();
    const Registration& right = truth.cell.registration;
    Cell stated = truth.stated();
    stated.registration.known_near = fixedAt(right.T_camera_near * aside);
    stated.registration.known_far = fixedAt(right.T_far_target);
    EXPECT_THAT(saidOf(stated, measurements), HasSubstr("T_camera_base is stated")) << turns;
    stated.registration.known_near = fixedAt(right.T_camera_near);
    stated.registration.known_far = fixedAt(right.T_far_target * aside);
    // A tool that never turns shows only both together.
    EXPECT_THAT(saidOf(stated, measurements), HasSubstr(turns ? "T_flange_target is stated" : "is stated")) << turns;
  }
}

class KnownRegistrationFile : public ::testing::Test {
 protected:
  Registration read(const std::string& text) const {
    std::ofstream(file_) << text;
    Registration registration;
    readKnownRegistration(file_, registration);
    return registration;
  }
  std::string errorOf(const std::string& text) const {
    try {
      read(text);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }

  test::TempFolder directory_;
  std::filesystem::path file_ = directory_.path() / "registration.yaml";
  const std::string format_ = "format: poecal-registration/1\n";
  const std::string pose_ = "position: [0.1, 0.2, 0.3], quaternion_xyzw: [0, 0, 0, 1]";
};

TEST_F(KnownRegistrationFile, HoldsFixedTransformsAndDeviations) {
  const Registration registration = read(format_ + "T_camera_base: {" + pose_ + ", fixed: true}\nT_flange_target: {" + pose_ +
                                         ", standard_deviation: {rotation: 0.01, translation: [0.001, 0.002, .inf]}}\n");
  ASSERT_TRUE(registration.known_near && registration.known_far);
  EXPECT_EQ(registration.known_near->T.translation(), Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(registration.known_near->sigma, Vector6d::Constant(KnownTransform::kFixed));
  EXPECT_EQ(registration.known_far->sigma.head<5>(), (Eigen::Vector<double, 5>() << 0.01, 0.01, 0.01, 0.001, 0.002).finished());
  EXPECT_TRUE(std::isinf(registration.known_far->sigma(5)));
}

TEST_F(KnownRegistrationFile, OfTheProgramItselfIsOne) {
  const Registration registration =
      read(format_ + "setup: eye_to_hand\nT_camera_base: {" + pose_ +
           "}\nstandard_deviation:\n  T_camera_base: {rotation: [1e-3, 1e-3, 1e-3], translation: [1e-3, 2e-3, 3e-3]}\n"
           "pictures: 40\n");
  ASSERT_TRUE(registration.known_near);
  EXPECT_FALSE(registration.known_far);
  EXPECT_EQ(registration.known_near->sigma(5), 3e-3);
}

TEST_F(KnownRegistrationFile, SaysWhatIsWrong) {
  EXPECT_THAT(errorOf(format_ + "T_camera_base: {" + pose_ + "}\n"), HasSubstr("registration.yaml:2: T_camera_base: says neither"));
  EXPECT_THAT(errorOf(format_ + "T_camera_base: {" + pose_ + ", fixed: true, standard_deviation: {rotation: 1, translation: 1}}\n"),
              HasSubstr("fixed, expected one of the two"));
  EXPECT_THAT(errorOf(format_ + "T_camera_flange: {" + pose_ + ", fixed: true}\n"), HasSubstr("expected T_camera_base or T_flange_target"));
  EXPECT_THAT(errorOf(format_ + "setup: eye_in_hand\nT_camera_base: {" + pose_ + ", fixed: true}\n"),
              HasSubstr("registration.yaml:2: setup: is eye_in_hand"));
  EXPECT_THAT(errorOf(format_), HasSubstr("holds no transform"));
  EXPECT_THAT(errorOf(format_ + "T_camera_base: {" + pose_ + ", standard_deviation: {rotation: -1, translation: 1}}\n"), Not(IsEmpty()));
  EXPECT_THAT(errorOf(format_ + "T_camera_base: {" + pose_ + ", standard_deviation: {rotation: [1, 1], translation: 1}}\n"),
              HasSubstr("has 2 numbers"));
}

}  // namespace
}  // namespace poecal
