#include <cmath>

#include <gmock/gmock.h>
#include <tinyxml2.h>

#include "poecal/core/error.hpp"
#include "poecal/robot/robot_file.hpp"
#include "robot/urdf_examples.hpp"
#include "support/kdl_chain.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using test::kScara;
using test::kSevenJoints;
using test::kSixJoints;
using test::UrdfExample;
using ::testing::HasSubstr;
using ::testing::Not;

// Origins carry 17 digits and a chain of ten poses of a metre loses two or three of them; far below what any arm repeats.
constexpr double kSamePose = 1e-13;

Arm read(const UrdfExample& example) { return readUrdf(example.file(), example.base_link, example.tip_link); }

std::string correct(const UrdfExample& example, const Arm& arm) {
  return correctedUrdf(example.file(), example.base_link, example.tip_link, arm);
}

// Millimetres and milliradians on every twist and on the flange.
Arm miscalibrated(const Arm& nominal, Rng& rng, double size = 3e-3) {
  Arm arm = displaceTwists(nominal, test::uniformVector(rng, twistParameterCount(nominal), size));
  arm.gamma = logSe3(expSe3(test::uniformVector(rng, 6, size)) * expSe3(arm.gamma));
  return arm;
}

void expectForwardKinematics(const std::string& urdf_text, const UrdfExample& example, const Arm& arm, Rng& rng) {
  const KDL::Chain chain = test::kdlChain(urdf_text, example.base_link, example.tip_link);
  ASSERT_EQ(static_cast<int>(chain.getNrOfJoints()), arm.jointCount());
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::VectorXd q = test::uniformVector(rng, arm.jointCount(), 3.0);
    EXPECT_THAT(test::kdlForwardKinematics(chain, q), test::PoseIsNear(forwardKinematics(arm, q), kSamePose)) << "trial " << trial;
  }
}

class CorrectedUrdf : public ::testing::TestWithParam<UrdfExample> {};

TEST_P(CorrectedUrdf, HasTheForwardKinematicsOfTheArm) {
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 10; ++trial) {
    const Arm arm = miscalibrated(read(GetParam()), rng);
    expectForwardKinematics(correct(GetParam(), arm), GetParam(), arm, rng);
  }
}

TEST_P(CorrectedUrdf, HoldsForLargeErrorsToo) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = miscalibrated(read(GetParam()), rng, 0.5);
  expectForwardKinematics(correct(GetParam(), arm), GetParam(), arm, rng);
}

TEST_P(CorrectedUrdf, ReadsBackAsTheSameTwists) {
  Rng rng = test::rngOfThisTest();
  const test::TempFolder folder;
  const Arm arm = miscalibrated(read(GetParam()), rng);
  const Arm again = readUrdf(folder.write("again.urdf", correct(GetParam(), arm)), GetParam().base_link, GetParam().tip_link);
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    EXPECT_THAT(again.joints[k].xi, test::IsNear(arm.joints[k].xi, kSamePose)) << arm.joints[k].name;
  }
  EXPECT_THAT(again.gamma, test::IsNear(arm.gamma, kSamePose));
}

TEST_P(CorrectedUrdf, NominalArmChangesNothing) {
  tinyxml2::XMLDocument original;
  ASSERT_EQ(original.Parse(GetParam().text().c_str()), tinyxml2::XML_SUCCESS);
  tinyxml2::XMLPrinter printer;
  original.Print(&printer);
  EXPECT_EQ(correct(GetParam(), read(GetParam())), printer.CStr());
}

INSTANTIATE_TEST_SUITE_P(Urdf, CorrectedUrdf, ::testing::Values(kSixJoints, kSevenJoints, kScara),
                         [](const auto& example) { return std::string(example.param.name); });

TEST(UrdfCorrection, KeepsEverythingElse) {
  Rng rng = test::rngOfThisTest();
  const std::string text = correct(kSixJoints, miscalibrated(read(kSixJoints), rng));
  for (const char* kept :
       {"<!-- Six revolute joints in the manner of a UR", "<!-- the visual stays as it is -->", "<?xml version=\"1.0\"?>",
        "package://arm/shoulder.dae", "<transmission name=\"elbow_transmission\">", "<selfCollide>true</selfCollide>",
        "<axis xyz=\"0 0.6 0.8\"/>", "<axis xyz=\"0 0 -2\"/>", "<mimic joint=\"finger_joint\"/>",
        "<origin xyz=\"0 -0.1197 0.425\" rpy=\"0.2 -0.1 0.3\"/>", "<origin xyz=\"0 0.0823 0\" rpy=\"0 0 1.5707963267948966\"/>"}) {
    EXPECT_THAT(text, HasSubstr(kept));
  }
  EXPECT_THAT(text, Not(HasSubstr("_carrier"))) << "the fixed joint before tool0 takes what is left over";
}

TEST(UrdfCorrection, OtherPointsOfTheSameAxesChangeNothing) {
  Arm arm = read(kScara);
  for (Joint& joint : arm.joints) joint.anchor += 0.3 * joint.axis();
  arm.joints[3].anchor += Eigen::Vector3d(1, 2, 3);  // a prismatic axis has no place at all
  EXPECT_EQ(correct(kScara, arm), correct(kScara, read(kScara)));
}

TEST(UrdfCorrection, AddsALinkBeforeATipOnTheLastJointOnlyWhereItMust) {
  Arm arm = read(kSevenJoints);
  // The frame may slide along and turn about the last axis: the joint's own origin takes that.
  arm.gamma = logSe3(expSe3(0.01 * arm.joints[6].xi) * Eigen::Translation3d(0.002 * arm.joints[6].axis()) * expSe3(arm.gamma));
  EXPECT_THAT(correct(kSevenJoints, arm), Not(HasSubstr("carrier")));
  arm.gamma = logSe3(Eigen::Translation3d(0.001, 0, 0) * expSe3(arm.gamma));
  EXPECT_THAT(correct(kSevenJoints, arm), HasSubstr("<link name=\"link_7_carrier\"/>"));
  EXPECT_THAT(correct(kSevenJoints, arm), HasSubstr("<joint name=\"link_7_calibrated\" type=\"fixed\">"));
}

TEST(UrdfCorrection, CanBeCorrectedAgain) {
  Rng rng = test::rngOfThisTest();
  const test::TempFolder folder;
  const Arm nominal = read(kSevenJoints);
  const auto once = folder.write("once.urdf", correct(kSevenJoints, miscalibrated(nominal, rng)));
  const Arm arm = miscalibrated(nominal, rng);
  const std::string twice = correctedUrdf(once, "link_0", "link_7", arm);
  expectForwardKinematics(twice, kSevenJoints, arm, rng);
  EXPECT_THAT(twice, Not(HasSubstr("carrier_"))) << "the fixed joint of the first correction serves again";
}

// Pitch +-90 degrees is where roll and yaw become one; a joint turned there from many sides must still be placed to rounding.
TEST(UrdfCorrection, PlacesFramesAtTheSingularityOfRpy) {
  Rng rng = test::rngOfThisTest();
  for (const double pitch : {M_PI / 2, -M_PI / 2, M_PI / 2 - 1e-9, M_PI / 2 - 1e-5, -M_PI / 2 + 1e-7}) {
    Arm arm = read(kSixJoints);
    const Eigen::Matrix3d R =
        (Eigen::AngleAxisd(rng.uniform(-3, 3), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rng.uniform(-3, 3), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    // tool0 hangs on frame flange with a rotation of its own: choose gamma so that this rotation is R.
    const Eigen::Isometry3d T_base_flange = expSe3(readUrdf(kSixJoints.file(), "base_link", "flange").gamma);
    arm.gamma = logSe3(T_base_flange * Eigen::Isometry3d(Eigen::AngleAxisd(R)));
    expectForwardKinematics(correct(kSixJoints, arm), kSixJoints, arm, rng);
  }
}

TEST(UrdfCorrection, RefusesAnArmOfOtherJoints) {
  EXPECT_THAT([] { correct(kSevenJoints, read(kScara)); },
              ::testing::ThrowsMessage<FileError>(
                  HasSubstr("seven_joints.urdf: joints from 'link_0' to 'link_7' are RRRRRRR, expected those of the model: RRRP")));
}

}  // namespace
}  // namespace poecal
