#include <algorithm>
#include <locale>
#include <ostream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

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
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

constexpr double kRounding = 1e-13;  // ten poses of a metre multiplied

class ReadUrdf : public ::testing::TestWithParam<test::UrdfExample> {};

TEST_P(ReadUrdf, HasTheForwardKinematicsOfKdl) {
  Rng rng = test::rngOfThisTest();
  const test::UrdfExample& example = GetParam();
  const Arm arm = readUrdf(example.file(), example.base_link, example.tip_link);
  const KDL::Chain chain = test::kdlChain(example.text(), example.base_link, example.tip_link);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd q = test::uniformVector(rng, arm.jointCount(), 3.0);
    EXPECT_THAT(forwardKinematics(arm, q), test::PoseIsNear(test::kdlForwardKinematics(chain, q), kRounding)) << "trial " << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Urdf, ReadUrdf, ::testing::Values(kSixJoints, kSevenJoints, kScara),
                         [](const auto& example) { return std::string(example.param.name); });

TEST(Urdf, ChainMayEndInsideTheTree) {
  Rng rng = test::rngOfThisTest();
  const Arm arm = readUrdf(kSixJoints.file(), "shoulder", "wrist_1_link");
  EXPECT_EQ(arm.jointCount(), 3);
  const KDL::Chain chain = test::kdlChain(kSixJoints.text(), "shoulder", "wrist_1_link");
  const Eigen::VectorXd q = test::uniformVector(rng, 3, 3.0);
  EXPECT_THAT(forwardKinematics(arm, q), test::PoseIsNear(test::kdlForwardKinematics(chain, q), kRounding));
}

TEST(Urdf, JointsKeepNameTypeOriginAndLimits) {
  const Arm arm = readUrdf(kScara.file(), "base", "quill");
  EXPECT_EQ(arm.name, "scara");
  ASSERT_EQ(arm.jointCount(), 4);
  EXPECT_EQ(arm.joints[1].name, "elbow");
  EXPECT_EQ(arm.joints[1].type, JointType::kRevolute);
  EXPECT_THAT(arm.joints[1].anchor, test::IsNear(Eigen::Vector3d(0.35, 0, 0.2), kRounding));
  ASSERT_TRUE(arm.joints[1].limits.has_value());
  EXPECT_EQ(arm.joints[1].limits->lower, -2.5);
  EXPECT_EQ(arm.joints[1].limits->upper, 2.5);
  EXPECT_FALSE(arm.joints[2].limits.has_value()) << "continuous";
  EXPECT_EQ(arm.joints[3].type, JointType::kPrismatic);
  EXPECT_THAT(arm.joints[3].axis(), test::IsNear(Eigen::Vector3d(0, 0, -1), kRounding));
  EXPECT_EQ(arm.joints[3].limits->upper, 0.2);
  EXPECT_TRUE(arm.links.empty());
}

TEST(Urdf, LimitWithoutARangeIsNone) {
  const Arm arm = readUrdf(kSixJoints.file(), "base_link", "tool0");
  EXPECT_FALSE(arm.joints[3].limits.has_value());
}

TEST(Urdf, MassesGoToTheJointThatCarriesThem) {
  const Arm arm = readUrdf(kSixJoints.file(), "base_link", "tool0");
  ASSERT_EQ(arm.links.size(), 6u);
  const KDL::Chain chain = test::kdlChain(kSixJoints.text(), "base_link", "elbow_bracket");
  const Eigen::Isometry3d T_base_bracket = test::kdlForwardKinematics(chain, Eigen::VectorXd::Zero(2));
  // The plate (40 kg) stands still; the bracket is fixed to the body of joint 2; the finger slides on that of joint 6.
  EXPECT_EQ(arm.links[0].mass, 3.7);
  EXPECT_THAT(arm.links[0].com, test::IsNear(Eigen::Vector3d(0, 0, 0.02 + 0.0892 + 0.01), kRounding));
  EXPECT_EQ(arm.links[1].mass, 2.0);
  EXPECT_THAT(arm.links[1].com, test::IsNear(Eigen::Vector3d(T_base_bracket * Eigen::Vector3d(0.1, 0, 0)), kRounding));
  EXPECT_EQ(arm.links[2].mass, 0.0);
  EXPECT_EQ(arm.links[5].mass, 0.5);
  EXPECT_THAT(arm.links[5].com, test::IsNear(Eigen::Vector3d(expSe3(arm.gamma) * Eigen::Vector3d(0, 0, 0.15)), kRounding));
}

TEST(Urdf, NumbersDoNotDependOnTheLocale) {
  struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::string text = kSixJoints.text();
  const Arm expected = readUrdf(kSixJoints.file(), "base_link", "tool0");
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const Arm arm = readUrdf(kSixJoints.file(), "base_link", "tool0");
  const std::string corrected =
      correctedUrdf(kSixJoints.file(), "base_link", "tool0", displaceTwists(arm, Eigen::VectorXd::Constant(24, 1e-3)));
  std::locale::global(before);
  EXPECT_EQ(arm.gamma, expected.gamma);
  EXPECT_EQ(arm.joints[0].limits->upper, 6.28);
  EXPECT_EQ(std::count(corrected.begin(), corrected.end(), ','), std::count(text.begin(), text.end(), ','));
}

TEST(Urdf, EndsAreTheRootAndTheLinksWithoutJoints) {
  const UrdfEnds ends = urdfEnds(kSixJoints.file());
  EXPECT_EQ(ends.root, "base_link");
  EXPECT_THAT(ends.leaves, ::testing::ElementsAre("finger", "other_finger"));
}

// One joint per line, so that a message can be held to its line.
constexpr char kSmall[] = R"(<robot name="small">
<link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="turn" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="weld" type="fixed"><parent link="b"/><child link="d"/></joint>
</robot>
)";

struct BadUrdf {
  const char* what;
  const char* old_text;
  const char* new_text;
  const char* base_link;
  const char* tip_link;
  const char* message;
};

// Without it GoogleTest prints, and CTest lists, the bytes of the pointers.
void PrintTo(const BadUrdf& value, std::ostream* out) { *out << value.what; }

const BadUrdf kBadUrdfs[] = {
    {"Xml", "</robot>", "", "a", "c", "small.urdf:1: not valid XML"},
    {"NotAUrdf", kSmall, "<sdf/>", "a", "c", "small.urdf:1: begins with <sdf>, expected <robot>"},
    {"NoElement", kSmall, "<!-- an arm -->\n", "a", "c", "small.urdf:1: begins with no element, expected <robot>"},
    {"RobotBehindAnElement", "<robot", "<sdf/>\n<robot", "a", "c", "small.urdf:1: begins with <sdf>, expected <robot>"},
    {"TwoRobots", "</robot>", "</robot>\n<robot/>", "a", "c", "small.urdf:7: goes on behind </robot>, expected nothing there"},
    {"TextBehind", "</robot>", "</robot>\nand so on<!-- -->", "a", "c", "goes on behind </robot>, expected nothing there"},
    {"NoSign", "\"turn\"", "\"turn&#xD800;\"", "a", "c", "small.urdf:3: holds a number of a sign (as &#xD800;) that there is not"},
    {"NoSignInAText", "</robot>", "<note>&#xDFFF;</note></robot>", "a", "c", "small.urdf:6: holds a number of a sign"},
    {"Number", "<joint name=\"slide\" type=\"prismatic\">", "<joint name=\"slide\" type=\"prismatic\"><origin xyz=\"0 0 1,5\"/>", "a", "c",
     "small.urdf:4: not a valid URDF: Unable to parse component [1,5] to a double"},
    {"Loose", "link=\"c\"", "link=\"x\"", "a", "b", "small.urdf:4: not a valid URDF: "},
    {"Inertial", "<link name=\"d\"/>", "\n<link name=\"d\"><inertial><mass value=\"1\"/></inertial></link>", "a", "c",
     "small.urdf:3: not a valid URDF: Inertial element must have inertia element"},
    {"NoBase", "", "", "base", "c", "small.urdf: link 'base' is not there, expected one of: a, b, c, d"},
    {"NoTip", "", "", "a", "tool0", "small.urdf: link 'tool0' is not there, expected one of: a, b, c, d"},
    {"UpsideDown", "", "", "c", "a", "small.urdf: base link 'c' lies below tip link 'a'"},
    {"Branches", "", "", "c", "d", "small.urdf: no chain leads from link 'c' to link 'd', they are on different branches"},
    {"NoJoint", "", "", "a", "a", "small.urdf: no moving joint between link 'a' and link 'a'"},
    {"OnlyFixed", "", "", "b", "d", "small.urdf: no moving joint between link 'b' and link 'd'"},
    {"Floating", "prismatic", "floating", "a", "c", "small.urdf:4: joint 'slide' is floating, expected revolute"},
    {"Planar", "prismatic", "planar", "a", "c", "small.urdf:4: joint 'slide' is planar, expected revolute"},
    {"Mimic", "<child link=\"c\"/>", "<child link=\"c\"/><mimic joint=\"turn\"/>", "a", "c", "small.urdf:4: joint 'slide' mimics 'turn'"},
    {"Axis", "<child link=\"c\"/><axis xyz=\"0 0 1\"/>", "<child link=\"c\"/><axis xyz=\"0 0 0\"/>", "a", "c",
     "small.urdf:4: joint 'slide' has an axis of length 0, expected a direction"},
    {"TinyAxis", "<child link=\"c\"/><axis xyz=\"0 0 1\"/>", "<child link=\"c\"/><axis xyz=\"0 0 1e-300\"/>", "a", "c",
     "small.urdf:4: joint 'slide' has an axis of length"},
    {"HugeAxis", "<child link=\"c\"/><axis xyz=\"0 0 1\"/>", "<child link=\"c\"/><axis xyz=\"0 0 1e308\"/>", "a", "c",
     "small.urdf:4: joint 'slide' has an axis of length"},
    {"Millimetres", "<child link=\"c\"/>", "<child link=\"c\"/><origin xyz=\"400 0 162.5\"/>", "a", "c",
     "small.urdf:4: joint 'slide' is 0.43 km from the base, expected metres: an arm in millimetres?"},
    {"TurnedInDegrees", "<child link=\"c\"/>", "<child link=\"c\"/><origin xyz=\"0 0 0\" rpy=\"0 -90 0\"/>", "a", "c",
     "small.urdf:4: rpy is '0 -90 0', more than a whole turn, expected radians; is it in degrees?"},
    {"HugeOrigin", "<child link=\"c\"/>", "<child link=\"c\"/><origin xyz=\"1e308 0 0\"/>", "a", "c", "an arm in millimetres?"},
    {"HugeMass", "<link name=\"c\"/>",
     "\n<link name=\"c\"><inertial><mass value=\"1e300\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
     "izz=\"1\"/></inertial></link>",
     "a", "c", "small.urdf:3: link 'c' has a mass of 1e+300 kg, expected the mass of an arm's link"},
    {"MassInGrams", "<link name=\"c\"/>",
     "\n<link name=\"c\"><inertial><mass value=\"3400\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
     "izz=\"1\"/></inertial></link>",
     "a", "c", "small.urdf:3: link 'c' has a mass of 3400 kg, expected the mass of an arm's link: is it in grams?"},
    {"NegativeMass", "<link name=\"c\"/>",
     "\n<link name=\"c\"><inertial><mass value=\"-3.4\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
     "izz=\"1\"/></inertial></link>",
     "a", "c", "small.urdf:3: link 'c' has a mass of -3.4 kg, expected 0 or more"},
    {"LimitsInDegrees", "lower=\"-1\" upper=\"1\"", "lower=\"-90\" upper=\"90\"", "a", "c",
     "small.urdf:3: joint 'turn' has limits -90.0 to 90.0, expected radians: are they in degrees?"},
    {"TravelInMillimetres", "<child link=\"c\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\"",
     "<child link=\"c\"/><axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"250\"", "a", "c",
     "small.urdf:4: joint 'slide' has limits 0.0 to 250.0, expected metres: are they in millimetres?"},
    {"LinkItsOwnParent", "</robot>",
     "<joint name=\"own\" type=\"fixed\"><parent link=\"e\"/><child link=\"e\"/></joint>\n<link name=\"e\"/>\n</robot>", "a", "c",
     "small.urdf:6: joint 'own' has links that form a ring, expected a tree"},
    {"RingBeside", "</robot>",
     "<joint name=\"to\" type=\"fixed\"><parent link=\"e\"/><child link=\"f\"/></joint>\n"
     "<joint name=\"fro\" type=\"fixed\"><parent link=\"f\"/><child link=\"e\"/></joint>\n<link name=\"e\"/><link name=\"f\"/>\n</robot>",
     "a", "c", "has links that form a ring, expected a tree"},
    {"RingThroughTheTip", "<parent link=\"b\"/><child link=\"d\"/>",
     "<parent link=\"c\"/><child link=\"b\"/></joint>\n<joint name=\"aside\" type=\"fixed\"><parent link=\"a\"/><child link=\"d\"/>", "a",
     "c", "(link 'b' is on joint 'turn' too), expected a tree"},
    {"RingOfTheWholeArm", "<parent link=\"a\"/>", "<parent link=\"c\"/>", "a", "c", "has links that form a ring, expected a tree"},
    {"TwoJointsCarryALink", "<child link=\"d\"/>",
     "<child link=\"c\"/></joint>\n<joint name=\"aside\" type=\"fixed\"><parent link=\"a\"/><child link=\"d\"/>", "a", "c",
     "(link 'c' is on joint 'slide' too), expected a tree"},
    {"NotUtf8", "\"turn\"", "\"dr\xe4hen\"", "a", "c", "small.urdf:3: byte 0xE4 is not UTF-8"},
    {"XacroElement", "<joint name=\"weld\"", "<xacro:property name=\"reach\" value=\"0.4\"/>\n<joint name=\"weld\"", "a", "c",
     "small.urdf:5: is a xacro, expected it expanded: xacro arm.urdf.xacro > arm.urdf"},
    {"XacroExpression", "<child link=\"c\"/>", "<child link=\"c\"/><origin xyz=\"${reach} 0 0\"/>", "a", "c", "small.urdf:4: is a xacro"},
    {"XacroArgument", "name=\"small\"", "name=\"$(arg name)\"", "a", "c", "small.urdf:1: is a xacro"},
    {"Limits", "lower=\"-1\"", "lower=\"2\"", "a", "c", "small.urdf:3: joint 'turn' has limits 2.0 to 1.0, expected lower < upper"},
};

TEST(Urdf, AJointWithoutAnEndHasNoLimitsWhateverItsFileSays) {
  const test::TempFolder folder;
  std::string text = kSmall;
  text.replace(text.find("revolute"), 8, "continuous");
  text.replace(text.find("lower=\"-1\" upper=\"1\""), 20, "lower=\"-360\" upper=\"360\"");
  const Arm arm = readUrdf(folder.write("small.urdf", text), "a", "c");
  EXPECT_FALSE(arm.joints[0].limits);
  EXPECT_EQ(arm.joints[0].largest_speed, 1.0);
}

class BadUrdfFile : public ::testing::TestWithParam<BadUrdf> {};

TEST_P(BadUrdfFile, IsRefusedOnceAndQuietly) {
  const test::TempFolder folder;
  const BadUrdf& bad = GetParam();
  std::string text = kSmall;
  text.replace(text.find(bad.old_text), std::string(bad.old_text).size(), bad.new_text);
  const auto file = folder.write("small.urdf", text);
  ::testing::internal::CaptureStderr();
  EXPECT_THAT([&] { readUrdf(file, bad.base_link, bad.tip_link); }, Throws<FileError>(Property(&FileError::what, HasSubstr(bad.message))));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

INSTANTIATE_TEST_SUITE_P(Urdf, BadUrdfFile, ::testing::ValuesIn(kBadUrdfs), [](const auto& bad) { return std::string(bad.param.what); });

TEST(Urdf, AnExpandedXacroKeepsItsNamespace) {
  const test::TempFolder folder;
  std::string text = kSmall;
  text.replace(text.find("<robot"), 6, "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\"");
  EXPECT_EQ(readUrdf(folder.write("small.urdf", text), "a", "c").jointCount(), 2);
}

TEST(Urdf, NumbersOfSignsInNamesAreRead) {
  // The readers of XML that take part have ideas of their own about these.
  for (const char* name : {"dr&#xE4;hen", "t&#117;rn", "a &amp; b", "turn&#10;ing", "turn&#0;", "turn&#x1b;", "&bogus;", "turn  "}) {
    const test::TempFolder folder;
    std::string text = kSmall;
    text.replace(text.find("\"turn\""), 6, fmt::format("\"{}\"", name));
    const auto file = folder.write("small.urdf", text);
    const Arm arm = readUrdf(file, "a", "c");
    EXPECT_EQ(arm.jointCount(), 2) << name;
    EXPECT_EQ(readUrdf(folder.write("again.urdf", correctedUrdf(file, "a", "c", arm)), "a", "c").joints[0].name, arm.joints[0].name)
        << name;
  }
}

TEST(Urdf, WhatBeginsAsXmlIsAUrdfWhateverItsName) {
  const test::TempFolder folder;
  EXPECT_EQ(readArm(folder.write("robot.yaml", std::string("\n  ") + kSmall), "a", "c").jointCount(), 2);
  EXPECT_THAT([&] { readArm(folder.write("arm.urdf", "format: poecal-robot/1\n"), "a", "c"); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("arm.urdf:1: not valid XML"))));
}

TEST(Urdf, AChainOfManyLinksIsAddedUp) {
  constexpr int kLinks = 20'000;
  std::string text =
      "<robot name=\"rope\">\n<link name=\"base\"/>\n"
      "<joint name=\"turn\" type=\"continuous\"><parent link=\"base\"/><child link=\"l0\"/><axis xyz=\"0 0 1\"/></joint>\n";
  for (int k = 0; k < kLinks; ++k) {
    text += fmt::format(
        "<link name=\"l{}\"><inertial><mass value=\"0.5\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
        "izz=\"1\"/></inertial></link>\n",
        k);
    if (k > 0) text += fmt::format("<joint name=\"j{0}\" type=\"fixed\"><parent link=\"l{1}\"/><child link=\"l{0}\"/></joint>\n", k, k - 1);
  }
  const test::TempFolder folder;
  const Arm arm = readUrdf(folder.write("rope.urdf", text + "</robot>\n"), "base", "l0");
  ASSERT_EQ(arm.links.size(), 1u);
  EXPECT_EQ(arm.links[0].mass, 0.5 * kLinks);
}

TEST(Urdf, FloatingAndMimicJointsElsewhereDoNotMatter) {
  const test::TempFolder folder;
  std::string text = kSmall;
  text.replace(text.find("prismatic"), 9, "floating");
  EXPECT_EQ(readUrdf(folder.write("small.urdf", text), "a", "d").jointCount(), 1);
}

}  // namespace
}  // namespace poecal
