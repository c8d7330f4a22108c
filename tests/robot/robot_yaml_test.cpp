#include "robot/robot_yaml.hpp"

#include <ostream>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/arms.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

// The example of the file format, with a link per joint.
constexpr char kRobot[] = R"(format: poecal-robot/1
name: puma560
joints:                                  # at q = 0, in base
  - {name: joint_1, type: revolute, axis: [0, 0, 1], point: [0.1, 0, 0.2], limits: [-2.8, 2.8]}
  - {name: joint_2, type: prismatic, axis: [0, 0.6, 0.8], limits: [0, 0.2]}
flange: {position: [0.25, 0.05, -0.02], quaternion_xyzw: [0, 0, 0, 1]}
links:
  - {mass: 4.1, com: [0.1, 0, 0.2]}
  - {mass: 0, com: [0, 0, 0]}
)";

std::string robotWith(const std::string& old_text, const std::string& new_text) {
  std::string text = kRobot;
  text.replace(text.find(old_text), old_text.size(), new_text);
  return text;
}

TEST(RobotYaml, ReadsTheExample) {
  const test::TempFolder folder;
  const Arm arm = readRobotYaml(folder.write("robot.yaml", kRobot));
  EXPECT_EQ(arm.name, "puma560");
  ASSERT_EQ(arm.jointCount(), 2);
  EXPECT_EQ(arm.joints[0].name, "joint_1");
  EXPECT_EQ(arm.joints[0].xi, (Vector6d() << 0, 0, 1, 0, -0.1, 0).finished());  // -w x point
  EXPECT_EQ(arm.joints[0].anchor, Eigen::Vector3d(0.1, 0, 0.2));
  ASSERT_TRUE(arm.joints[0].limits.has_value());
  EXPECT_EQ(arm.joints[0].limits->lower, -2.8);
  EXPECT_EQ(arm.joints[0].limits->upper, 2.8);
  EXPECT_EQ(arm.joints[1].type, JointType::kPrismatic);
  EXPECT_EQ(arm.joints[1].xi, (Vector6d() << 0, 0, 0, 0, 0.6, 0.8).finished());
  EXPECT_EQ(arm.gamma, (Vector6d() << 0, 0, 0, 0.25, 0.05, -0.02).finished());
  ASSERT_EQ(arm.links.size(), 2u);
  EXPECT_EQ(arm.links[0].mass, 4.1);
  EXPECT_EQ(arm.links[0].com, Eigen::Vector3d(0.1, 0, 0.2));
}

void expectSame(const Arm& read, const Arm& written) {
  EXPECT_EQ(read.name, written.name);
  ASSERT_EQ(read.jointCount(), written.jointCount());
  for (std::size_t k = 0; k < read.joints.size(); ++k) {
    EXPECT_EQ(read.joints[k].name, written.joints[k].name);
    EXPECT_EQ(read.joints[k].type, written.joints[k].type);
    EXPECT_EQ(read.joints[k].xi, written.joints[k].xi);
    EXPECT_EQ(read.joints[k].anchor, written.joints[k].anchor);
    EXPECT_EQ(read.joints[k].limits.has_value(), written.joints[k].limits.has_value());
  }
  EXPECT_THAT(read.gamma, test::IsNear(written.gamma, 1e-15));  // through a unit quaternion and back
  ASSERT_EQ(read.links.size(), written.links.size());
  for (std::size_t k = 0; k < read.links.size(); ++k) {
    EXPECT_EQ(read.links[k].mass, written.links[k].mass);
    EXPECT_EQ(read.links[k].com, written.links[k].com);
  }
}

Arm awkwardArm() {
  Rng rng = test::rngOfThisTest();
  Arm arm = test::randomArm(rng, "RPRP");
  arm.name = "arm: [left, \"old\"]";
  arm.joints[1].name = "lift, then {turn}";
  arm.joints[2].limits = JointLimits{-1.0 / 3.0, 1e-9};
  arm.joints[3].anchor.setZero();
  for (int k = 0; k < 4; ++k) arm.links.push_back({rng.uniform(), test::uniformVector(rng, 3, 1.0)});
  return arm;
}

TEST(RobotYaml, WhatIsWrittenReadsBack) {
  const test::TempFolder folder;
  const Arm arm = awkwardArm();
  const Arm read = readRobotYaml(folder.write("robot.yaml", robotYaml(arm)));
  expectSame(read, arm);
  ASSERT_TRUE(read.joints[2].limits.has_value());
  EXPECT_EQ(read.joints[2].limits->lower, -1.0 / 3.0);
  EXPECT_EQ(read.joints[2].limits->upper, 1e-9);
}

TEST(RobotYaml, MapInsideAnotherFileReadsBack) {
  const test::TempFolder folder;
  const Arm arm = awkwardArm();
  const YamlNode root =
      YamlNode::load(folder.write("model.yaml", "format: poecal-model/1\nrobot:\n" + robotMapYaml(arm, 2) + "effects: []\n"));
  expectSame(readRobotMap(root["robot"]), arm);
}

TEST(RobotYaml, AxisWithSixDecimalsIsNormalised) {
  const test::TempFolder folder;
  const Arm arm = readRobotYaml(folder.write("robot.yaml", robotWith("[0, 0, 1]", "[0.577350, 0.577350, 0.577350]")));
  EXPECT_NEAR(arm.joints[0].axis().norm(), 1.0, 1e-15);
}

struct BadRobot {
  const char* what;
  const char* old_text;
  const char* new_text;
  const char* message;
};

// Without it GoogleTest prints, and CTest lists, the bytes of the pointers.
void PrintTo(const BadRobot& value, std::ostream* out) { *out << value.what; }

const BadRobot kBadRobots[] = {
    {"AxisLength", "axis: [0, 0, 1]", "axis: [0, 0, 1.1]", "robot.yaml:4: joints[0].axis: length 1.1, expected a unit vector"},
    {"NoPoint", "point: [0.1, 0, 0.2], ", "", "robot.yaml:4: joints[0]: key 'point' is missing"},
    {"Limits", "[0, 0.2]", "[0.2, 0]", "robot.yaml:5: joints[1].limits: are 0.2 to 0.0, expected lower < upper"},
    {"Type", "prismatic", "sliding", "robot.yaml:5: joints[1].type: is 'sliding', expected revolute or prismatic"},
    {"UnknownKey", "point:", "pont:", "robot.yaml:4: unknown key 'pont' in joints[0]"},
    {"UnknownKeyOfTheArm", "flange:", "tool:", "robot.yaml:6: unknown key 'tool'"},
    {"LinkCount", "  - {mass: 0, com: [0, 0, 0]}\n", "", "links: 1 links, expected one per joint: 2"},
    {"Mass", "mass: 4.1", "mass: -4.1", "robot.yaml:8: links[0].mass: is -4.1 kg, expected 0 or more"},
    {"Millimetres", "point: [0.1, 0, 0.2]", "point: [100, 0, 200]",
     "robot.yaml:4: joints[0].point: is 0.22 km from the base, expected metres: an arm in millimetres?"},
    {"FlangeInMillimetres", "flange: {position: [", "flange: {position: [1000", "robot.yaml:6: flange: is "},
    {"HugePoint", "point: [0.1, 0, 0.2]", "point: [1e308, 0, 0.2]", "robot.yaml:4: joints[0].point[0]: expected a finite number"},
    {"HugeMass", "mass: 4.1", "mass: 4.1e9", "robot.yaml:8: links[0].mass: is 4.1e+09 kg, expected the mass of an arm's link"},
    {"MassInGrams", "mass: 4.1", "mass: 4100",
     "robot.yaml:8: links[0].mass: is 4100 kg, expected the mass of an arm's link: is it in grams?"},
    {"LimitsInDegrees", "[-2.8, 2.8]", "[-160, 160]",
     "robot.yaml:4: joints[0].limits: are -160.0 to 160.0, expected radians: are they in degrees?"},
    {"TravelInMillimetres", "[0, 0.2]", "[0, 200]", "robot.yaml:5: joints[1].limits: are 0.0 to 200.0, expected metres"},
    {"KeyTwice", "name: ", "name: again\nname: ", "is there twice"},
    {"Format", "poecal-robot/1", "poecal-robot/2", "robot.yaml:1: format: is 'poecal-robot/2', expected poecal-robot/1"},
    {"Quaternion", "[0, 0, 0, 1]", "[0, 0, 1, 1]", "robot.yaml:6: flange.quaternion_xyzw: length 1.414214, expected a unit quaternion"},
};

class BadRobotYaml : public ::testing::TestWithParam<BadRobot> {};

TEST_P(BadRobotYaml, IsRefusedWithItsLine) {
  const test::TempFolder folder;
  const auto file = folder.write("robot.yaml", robotWith(GetParam().old_text, GetParam().new_text));
  EXPECT_THAT([&] { readRobotYaml(file); }, Throws<FileError>(Property(&FileError::what, HasSubstr(GetParam().message))));
}

INSTANTIATE_TEST_SUITE_P(RobotYaml, BadRobotYaml, ::testing::ValuesIn(kBadRobots),
                         [](const auto& bad) { return std::string(bad.param.what); });

TEST(RobotYaml, FormatInsideAnotherFileIsAnUnknownKey) {
  const test::TempFolder folder;
  const YamlNode root = YamlNode::load(folder.write("model.yaml", "robot: {format: poecal-robot/1}\n"));
  EXPECT_THAT([&] { readRobotMap(root["robot"]); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("unknown key 'format' in robot"))));
}

}  // namespace
}  // namespace poecal
