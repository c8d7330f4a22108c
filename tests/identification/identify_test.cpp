#include "poecal/identification/identify.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "cell/linearisation.hpp"
#include "identification/simulated_cell.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/registration/implausible.hpp"
#include "poecal/simulation/simulate.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using test::plainBundle;
using test::Simulated;
using test::simulated;
using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

TEST(Identify, AnArmThatExplainsNothingIsNone) {
  Simulated data = simulated("cobot6", 3, 60, 0);
  std::vector<double> last;
  for (const Observation& observation : data.calibration) last.push_back(observation.q(5));
  std::rotate(last.begin(), last.begin() + 1, last.end());
  // The joint turns about the flange's axis: with its readings a row late every picture is of another turn, and nothing else is wrong.
  for (std::size_t k = 0; k < last.size(); ++k) data.calibration[k].q(5) = last[k];
  EXPECT_THAT([&] { identify(data.nominal, data.measurements(), plainBundle()); }, Throws<ImplausibleCapture>());
}

TEST(Identify, AFifthOfWrongRowsIsListedAndDoesNotMoveTheModel) {
  Simulated data = simulated("cobot6", 3, 60, 0);
  const Identification clean = identify(data.nominal, data.measurements(), plainBundle());
  Rng rng = test::rngOfThisTest();
  std::vector<std::size_t> wrong;
  for (std::size_t k = 0; k < data.calibration.size(); k += 5) {
    wrong.push_back(data.calibration[k].sample);
    if (k % 2 == 0) {
      data.calibration[k].q = data.calibration[(k + 7) % data.calibration.size()].q;  // another row's joints
    } else {
      for (CornerMeasurement& corner : data.calibration[k].corners) {
        corner.px += Eigen::Vector2d(rng.uniform(-60, 60), rng.uniform(-60, 60));
      }
    }
  }
  const Identification found = identify(data.nominal, data.measurements(), plainBundle());
  std::vector<std::size_t> left_out;
  for (const SuspectRow& row : found.suspects) {
    if (row.left_out) left_out.push_back(row.sample);
  }
  EXPECT_THAT(left_out, ::testing::IsSupersetOf(wrong));
  EXPECT_LE(left_out.size(), wrong.size() + 1);
  const Eigen::VectorXd moved = (found.adjustment.beta - clean.adjustment.beta).cwiseAbs();
  const Eigen::VectorXd deviation = found.parameter_deviation.head(moved.size());
  EXPECT_TRUE((moved.array() < 2.0 * deviation.array()).all()) << (moved.array() / deviation.array()).transpose();
}

TEST(Identify, AllThreeMethodsAgreeAndHoldTheJointConstraints) {
  const Simulated data = simulated("cobot6", 4, 60, 40);
  double rms[3];
  int next = 0;
  for (const Method method : {Method::kBundle, Method::kWeighted, Method::kGao}) {
    IdentifyOptions options = plainBundle();
    options.method = method;
    const Identification found = identify(data.nominal, data.measurements(), options);
    for (const Joint& joint : found.model.cell.arm->joints) {
      EXPECT_NEAR(joint.xi.head<3>().norm(), 1.0, 1e-12);
      EXPECT_NEAR(joint.xi.head<3>().dot(joint.xi.tail<3>()), 0.0, 1e-12);
    }
    ErrorCollector errors;
    for (const Observation& observation : data.unseen) errors.add(found.model.cell, 0, observation);
    rms[next++] = errors.summary().px.rms;
  }
  ErrorCollector before;
  Cell registered = registerCell(data.nominal, data.calibration, {}).cell;
  for (const Observation& observation : data.unseen) before.add(registered, 0, observation);
  EXPECT_LT(rms[0], 0.1);                            // below the noise of one corner
  EXPECT_LT(rms[1], 2.0 * rms[0]);                   // poses carry nearly all that the corners know
  EXPECT_LT(rms[2], 0.5 * before.summary().px.rms);  // unweighted still beats no identification
}

TEST(Identify, HeldOutPosesFallFromRungToRung) {
  const Simulated data = simulated("arm7", 5, 60, 0);
  IdentifyOptions options;
  options.camera = CameraChoice::kStated;
  const Identification found = identify(data.nominal, data.measurements(), options);
  ASSERT_EQ(found.stages.size(), 3u);
  EXPECT_EQ(found.held_out_poses, 60);  // each judges once
  EXPECT_LT(found.stages[2].held_out.px.rms, 0.2 * found.stages[1].held_out.px.rms);
  EXPECT_LE(found.stages[1].held_out.px.rms, 1.2 * found.stages[0].held_out.px.rms);
}

TEST(Identify, AStillJointIsAnErrorByName) {
  Simulated data = simulated("cobot6", 6, 40, 0);
  for (Observation& observation : data.calibration) observation.q(3) = 0.25;
  EXPECT_THAT([&] { identify(data.nominal, data.measurements(), plainBundle()); },
              ::testing::ThrowsMessage<InsufficientData>(::testing::HasSubstr("joint 4")));
}

TEST(Identify, TooFewPosesSaysHowManyAreNeeded) {
  Simulated data = simulated("cobot6", 6, 4, 0);
  EXPECT_THAT([&] { identify(data.nominal, data.measurements(), plainBundle()); },
              ::testing::ThrowsMessage<InsufficientData>(::testing::HasSubstr("take at least 7 poses")));
}

TEST(Identify, JointsInDegreesAreSuspected) {
  Simulated data = simulated("cobot6", 7, 40, 0);
  for (Observation& observation : data.calibration) observation.q *= 180.0 / M_PI;
  EXPECT_THAT([&] { identify(data.nominal, data.measurements(), plainBundle()); },
              ::testing::ThrowsMessage<ImplausibleInput>(::testing::HasSubstr("degrees")));
}

TEST(Identify, AWrongLensIsSaidAndARightOneIsNot) {
  Simulated data = simulated("cobot6", 8, 60, 0);
  IdentifyOptions options;
  const Identification right = identify(data.nominal, data.measurements(), options);
  EXPECT_FALSE(right.camera_refitted);
  data.nominal.camera->distortion.setZero();
  const Identification wrong = identify(data.nominal, data.measurements(), options);
  EXPECT_TRUE(wrong.camera_refitted);
  EXPECT_THAT(wrong.warnings, ::testing::Contains(::testing::HasSubstr("the stated lens is wrong")));
  EXPECT_NEAR(wrong.model.cell.camera->distortion(0), data.truth.camera->distortion(0),
              5.0 * wrong.model.cell.camera->standard_deviation(4));
}

TEST(Identify, ModelFileReadsBackAsTheSameModel) {
  const Simulated data = simulated("scara", 9, 40, 5);
  Identification found = identify(data.nominal, data.measurements(), plainBundle());
  found.model.target = data.target;
  const test::TempFolder folder;
  const AppliedEffect backlash =
      makeEffect({.effect = "joint_backlash", .location = "joint:2", .parameters = {{"half_gap", 3.1e-4}}, .driver = ""}, found.model.cell);
  found.model.effects = {backlash};
  const Model model = readModel(folder.write("model.yaml", modelYaml(found.model)));
  std::string turned = modelYaml(found.model);
  turned.replace(turned.find("setup: eye_to_hand"), 18, "setup: eye_in_hand");
  EXPECT_THAT([&] { readModel(folder.write("turned.yaml", turned)); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("setup: is 'eye_in_hand', expected eye_to_hand as the transforms"))));
  for (const Observation& observation : data.unseen) {
    const auto expected = found.model.cell.registration.cameraTarget(modelFlange(found.model.cell, observation));
    EXPECT_THAT(model.cell.registration.cameraTarget(modelFlange(model.cell, observation)), test::PoseIsNear(expected, 1e-13));
  }
  EXPECT_EQ(model.cell.camera->parameters(), found.model.cell.camera->parameters());
  ASSERT_EQ(model.effects.size(), 1u);
  EXPECT_EQ(model.effects.front().effect.name() + " " + model.effects.front().effect.location(), "joint_backlash joint:2");
  EXPECT_EQ(model.effects.front().parameters, backlash.parameters);
}

TEST(Identify, ReportIsJsonWithEveryPartOfTheContract) {
  const Simulated data = simulated("puma560", 10, 40, 0);
  const Identification found = identify(data.nominal, data.measurements(), plainBundle());
  std::vector<Sample> samples(data.calibration.size());
  const nlohmann::json json = nlohmann::json::parse(identificationJson(found, samples));
  EXPECT_EQ(json["joints"].size(), 6u);
  EXPECT_EQ(json["observability"]["rank"], 6 * 4 + 12);
  for (const char* key : {"iterations", "gamma", "residuals", "noise", "stages", "suspects"}) EXPECT_TRUE(json.contains(key)) << key;
}

/// A simulated cell whose true arm is displaced by a factor more.
test::Simulated looseCell(double factor) {
  test::Simulated data = test::simulated("cobot6", 31, 40, 0);
  // The twists that lead from the nominal arm to the true one, in the logarithm: the same draws, so many times as far.
  Rng rng(31, 7);
  Eigen::VectorXd beta(twistParameterCount(*data.nominal.arm));
  for (Eigen::Index k = 0; k < beta.size(); ++k) beta(k) = factor * (k % 4 < 2 ? 2e-3 : 6e-4) * rng.normal();
  const Arm actual = displaceTwists(*data.nominal.arm, beta);
  for (Observation& observation : data.calibration) {
    for (CornerMeasurement& corner : observation.corners) {
      const Eigen::Vector3d before =
          data.truth.registration.cameraTarget(forwardKinematics(*data.truth.arm, observation.q)) * corner.p_target;
      const Eigen::Vector3d now = data.truth.registration.cameraTarget(forwardKinematics(actual, observation.q)) * corner.p_target;
      corner.px += *project(*data.truth.camera, now) - *project(*data.truth.camera, before);
    }
  }
  return data;
}

TEST(Identify, HowFarTheArmExceedsItsToleranceIsEstimatedAndTold) {
  // Drawn as far as the tolerances let an axis stand by itself, 0.94 of 3 mrad / sqrt(2), and at ten times as much. Six of the 24 squares
  // are those of a frame that nobody sees: a root of the others scatters by a sixth, three times that.
  const double tight = identify(looseCell(1.0).nominal, looseCell(1.0).measurements(), plainBundle()).arm_beyond_tolerance;
  const test::Simulated loose = looseCell(10.0);
  const double far = identify(loose.nominal, loose.measurements(), plainBundle()).arm_beyond_tolerance;
  EXPECT_LT(tight, 1.3);
  EXPECT_NEAR(far / 9.4, 1.0, 0.5);
}

TEST(Identify, TheBaseFrameIsWhereTheAxesAreNearestToNominal) {
  const test::Simulated data = test::simulated("cobot6", 32, 40, 0);
  const Identification found = identify(data.nominal, data.measurements(), plainBundle());
  // A motion of the base moves all axes alike; no derivative of beta' P beta along it is left, in units of its own root.
  const Eigen::VectorXd& beta = found.adjustment.beta;
  const Eigen::VectorXd pull = found.twist_prior.precision * beta;
  Eigen::MatrixXd along(beta.size(), 6);
  int row = 0;
  for (const Joint& joint : data.nominal.arm->joints) {
    const Matrix6Xd moved = adjointOfTwist(joint.xi) * twistBasis(joint);
    const int size = twistParameterCount(joint);
    along.middleRows(row, size) = moved.completeOrthogonalDecomposition().solve(adjointOfTwist(joint.xi));
    row += size;
  }
  for (int k = 0; k < 6; ++k) {
    const double unit = std::sqrt(along.col(k).dot(found.twist_prior.precision * along.col(k)));
    // The derivative is exact only at the nominal arm; the axes moved by milliradians.
    EXPECT_LT(std::abs(along.col(k).dot(pull)) / unit, 0.02) << k;
  }
}

// Turned about the first axis, links that are too long reach less far: no such turn is to be had for that.
TEST(Identify, LinksOfAnotherLengthTurnNoBase) {
  Simulated data = simulated("cobot6", 33, 40, 0);
  for (std::size_t k = 2; k < data.nominal.arm->joints.size(); ++k) {
    Joint& joint = data.nominal.arm->joints[k];
    joint = Joint::revolute(joint.name, joint.axis(), joint.anchor + Eigen::Vector3d(0.007, 0.0, 0.0));
  }
  const Identification found = identify(data.nominal, data.measurements(), plainBundle());
  const Vector6d& shoulder = found.model.cell.arm->joints[1].xi;
  const double turned = std::atan2(-shoulder(0), shoulder(1));  // about z, of an axis along y
  EXPECT_LT(std::abs(turned), 0.01) << "five times what the axes are off by";
  for (const std::string& warning : found.warnings) EXPECT_THAT(warning, ::testing::Not(HasSubstr("its zero is")));
}

TEST(Identify, DeviationsOfAnotherUnitInSomeRowsAreSaid) {
  Simulated data = simulated("cobot6", 34, 40, 0);
  const auto warnings = [&data] {
    Measurements measurements = data.measurements();
    measurements.sigmas_stated = true;
    return identify(data.nominal, measurements, plainBundle()).warnings;
  };
  EXPECT_THAT(warnings(), ::testing::Not(::testing::Contains(HasSubstr("different units"))));
  for (std::size_t k = 20; k < data.calibration.size(); ++k) {
    for (CornerMeasurement& corner : data.calibration[k].corners) corner.sigma_px = 7e-3;
  }
  EXPECT_THAT(warnings(), ::testing::Not(::testing::Contains(HasSubstr("different units")))) << "too sure, as detectors may be";
  for (std::size_t k = 20; k < data.calibration.size(); ++k) {
    for (CornerMeasurement& corner : data.calibration[k].corners) corner.sigma_px = 1e-3;
  }
  EXPECT_THAT(warnings(), ::testing::Contains(HasSubstr("20 of 40 rows state deviations of 0.001 px and are off by")));
}

}  // namespace
}  // namespace poecal
