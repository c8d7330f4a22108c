#include <fmt/format.h>
#include <gmock/gmock.h>

#include "capture/test_arm.hpp"
#include "poecal/capture/capture.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

class Samples : public ::testing::Test {
 protected:
  SampleTable read(const std::string& content) const {
    return readSamples(folder_.write("samples.csv", content), arm_.jointCount(), &arm_);
  }
  std::string errorOf(const std::string& content) const {
    return test::messageOf<FileError>([&] { read(content); });
  }
  test::TempFolder folder_;
  Arm arm_ = test::smallArm();
};

TEST_F(Samples, EveryColumnOfTheContractIsRead) {
  const SampleTable table = read(
      "image,q1,q2,q3,pose,stamp,dir1,dir2,dir3,dq1,dq2,dq3,temperature,payload,x,y,z,qx,qy,qz,qw,humidity,operator\n"
      "a.png,0.1,0.2,0.03,4,10.5,-1,0,1,0.5,0.6,0.7,21.5,2,1,2,3,0,0,0.70710678,0.70710678,40,anna\n"
      "b.png,1.1,0.2,0.03,,,-1,0,1,0.5,0.6,0.7,,,1,2,3,0,0,0,1,41,7\n");
  ASSERT_EQ(table.samples.size(), 2u);
  const Sample& a = table.samples[0];
  EXPECT_TRUE(table.has_joints && table.has_flange_poses);
  EXPECT_EQ(a.image, "a.png");
  EXPECT_EQ(a.line, 2);
  EXPECT_THAT(a.q, test::IsNear(Eigen::Vector3d(0.1, 0.2, 0.03), 0.0));
  EXPECT_THAT(a.dir, test::IsNear(Eigen::Vector3d(-1, 0, 1), 0.0));
  EXPECT_THAT(a.dq, test::IsNear(Eigen::Vector3d(0.5, 0.6, 0.7), 0.0));
  EXPECT_EQ(a.pose, 4);
  EXPECT_EQ(a.stamp, 10.5);
  EXPECT_EQ(a.temperature, 21.5);
  EXPECT_EQ(a.payload, 2.0);
  // A quarter turn about z takes x to y.
  EXPECT_THAT(Eigen::Vector3d(*a.T_base_flange * Eigen::Vector3d(1, 0, 0)), test::IsNear(Eigen::Vector3d(1, 3, 3), 1e-12));
  EXPECT_THAT(table.other_columns, ElementsAre("humidity", "operator"));
  EXPECT_EQ(a.other[0], 40.0);
  EXPECT_TRUE(std::isnan(a.other[1])) << "a text is not a number";
  EXPECT_EQ(table.samples[1].other[1], 7.0);
  EXPECT_FALSE(table.samples[1].pose || table.samples[1].stamp || table.samples[1].temperature || table.samples[1].payload);
}

TEST_F(Samples, WhatIsWrittenReadsBackAsItWas) {
  const std::string text =
      "image,q1,q2,q3,pose,dir1,dir2,dir3,payload,humidity\n"
      "\"a,1.png\",0.1,0.2,0.03,4,-1,0,1,,40.5\n"
      "b.png,0.3333333333333333,0.2,0.03,,-1,0,1,2.0,\n";
  EXPECT_EQ(samplesCsv(read(text)), text);
}

TEST_F(Samples, FlangePosesSurviveWriting) {
  const SampleTable table = read("image,x,y,z,qx,qy,qz,qw\na.png,1,2,3,0.5,-0.5,0.5,0.5\nb.png,0.1,0.2,0.3,0.6,0,0,0.8\n");
  EXPECT_FALSE(table.has_joints);
  const SampleTable back = read(samplesCsv(table));
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_THAT(*back.samples[k].T_base_flange, test::PoseIsNear(*table.samples[k].T_base_flange, 1e-15))
        << "one rounding of the quaternion";
  }
}

TEST_F(Samples, WithoutReadingsAnArmMayBeKnownAllTheSame) {
  for (const bool limits : {true, false}) {
    arm_ = test::smallArm(limits);
    EXPECT_EQ(read("image,x,y,z,qx,qy,qz,qw\na.png,1,2,3,0,0,0,1\nb.png,2,2,3,0,0,0,1\n").samples.size(), 2u) << limits;
  }
}

TEST_F(Samples, JointsAreCountedWhereNoArmIsKnown) {
  const auto file = folder_.write("samples.csv", "image,q1,q2,dir1,dir2,q1_raw\na.png,50,2,0,1,5\nb.png,3,4,0,1,6\n");
  const SampleTable table = readSamples(file, 0, nullptr);
  EXPECT_EQ(table.samples[0].q.size(), 2);
  EXPECT_THAT(table.other_columns, ElementsAre("q1_raw"));
}

TEST_F(Samples, BadCellsAreNamedWithTheirLine) {
  const std::string head = "image,q1,q2,q3\n";
  const std::string row = "a.png,0,0,0\n";
  EXPECT_THAT(errorOf(head + row + "b.png,0,oops,0\n"), HasSubstr("samples.csv:3: q2 is 'oops', expected a finite number"));
  EXPECT_THAT(errorOf(head + row + "b.png,0,nan,0\n"), HasSubstr("samples.csv:3: q2 is 'nan'"));
  EXPECT_THAT(errorOf(head + row + "b.png,0,,0\n"), HasSubstr("samples.csv:3: q2 is ''"));
  EXPECT_THAT(errorOf(head + row + "b.png,1,0,0\na.png,1,1,0\n"), HasSubstr("samples.csv:4: image 'a.png' is in line 2 already"));
  EXPECT_THAT(errorOf(head + row + ",1,0,0\n"), HasSubstr("samples.csv:3: the image is empty"));
  EXPECT_THAT(errorOf("image,q1,q2,q3,dir1,dir2,dir3\na.png,0,0,0,0,2,0\n"), HasSubstr("samples.csv:2: dir2 is 2, expected -1, 0 or 1"));
  EXPECT_THAT(errorOf("image,q1,q2,q3,pose\na.png,0,0,0,1.5\n"), HasSubstr("samples.csv:2: pose is '1.5', expected an integer"));
  EXPECT_THAT(errorOf("image,x,y,z,qx,qy,qz,qw\na.png,0,0,0,0,0,0,0\n"),
              HasSubstr("samples.csv:2: the quaternion has length 0.000000, expected 1"));
  EXPECT_THAT(errorOf("image,x,y,z,qx,qy,qz,qw\na.png,0,0,0,0,0,0,1.002\n"), HasSubstr("length 1.002000"));
}

TEST_F(Samples, BadHeadersAreNamed) {
  EXPECT_THAT(errorOf("q1,q2,q3\n0,0,0\n"), HasSubstr("samples.csv:1: column 'image' is missing"));
  EXPECT_THAT(errorOf("image,q1,q3\na.png,0,0\n"), HasSubstr("samples.csv:1: column 'q2' is missing"));
  EXPECT_THAT(errorOf("image,q1,q2,q3,q4\na.png,0,0,0,0\n"), HasSubstr("column 'q4', but the robot has 3 joints"));
  EXPECT_THAT(errorOf("image,q0,q1,q2\na.png,0,0,0\n"), HasSubstr("column 'q0': joints count from 1"));
  EXPECT_THAT(errorOf("image,q1,q2,q3,dq2\na.png,0,0,0,0\n"), HasSubstr("column 'dq1' is missing"));
  EXPECT_THAT(errorOf("image,x,y,z\na.png,0,0,0\n"), HasSubstr("column 'qx' is missing"));
  EXPECT_THAT(errorOf("image,stamp\na.png,0\n"), HasSubstr("samples.csv:1: neither joint readings nor flange poses"));
  EXPECT_THAT(errorOf("image,slide,joint_2,joint_1\na.png,0,0,0\n"), HasSubstr("; rename 'joint_1' to q1 and so on"));
  EXPECT_THAT(errorOf("image,J1 [rad],J2 [rad],J3 [m]\na.png,0,0,0\n"), HasSubstr("; rename 'J1 [rad]' to q1 and so on"));
  arm_.joints[1].name = "elbow_joint";
  EXPECT_THAT(errorOf("image,pan,elbow,out\na.png,0,0,0\n"), HasSubstr("; rename 'elbow' to q2 and so on"));
  EXPECT_THAT(errorOf("image,x,y,z,rx,ry,rz\na.png,0,0,0,0,0,0\n"),
              HasSubstr("samples.csv:1: columns rx, ry, rz are not read, expected the orientation as a quaternion in qx, qy, qz, qw"));
}

TEST_F(Samples, ReadingsBeyondTheLimitsAreRefusedWithTheLikelyUnit) {
  const std::string head = "image,q1,q2,q3\na.png,0,0,0\n";
  EXPECT_THAT(errorOf(head + "b.png,0,45.3,0\n"),
              EndsWith("samples.csv:3: q2 is 45.3, beyond the limits [-1.78, 1.78] of joint_2; are the readings in degrees?"));
  EXPECT_THAT(errorOf(head + "b.png,0,0,120\n"),
              EndsWith("q3 is 120, beyond the limits [0, 0.2] of slide; are the readings in millimetres?"));
  // 400 degrees are beyond the limits too, and 2 rad are no likely degrees: no unit explains them.
  EXPECT_THAT(errorOf(head + "b.png,0,400,0\n"), EndsWith("of joint_2"));
  EXPECT_THAT(errorOf(head + "b.png,0,2.0,0\n"), EndsWith("of joint_2"));
}

TEST_F(Samples, AReadingThatIsAWholeTurnAwayIsSaidToBe) {
  const std::string head = "image,q1,q2,q3\na.png,0.3,0,0\n";
  EXPECT_THAT(errorOf(head + "b.png,-4.4,0,0\n"),
              EndsWith("samples.csv:3: q1 is -4.4, beyond the limits [-2, 2] of joint_1; are the readings in degrees?; 1.88319, a whole "
                       "turn away, is within them: do the readings wrap around?"));
  EXPECT_THAT(errorOf(head + "b.png,-3.5,0,0\n"), EndsWith("of joint_1")) << "2.78 is beyond them too";
  EXPECT_THAT(errorOf(head + "b.png,-4.4,0,0\nc.png,9,0,0\n"), EndsWith("degrees?")) << "turns do not explain all rows";
}

TEST_F(Samples, AnArmMayPassItsLimitsALittle) {
  // 5 % of the range of joint_2, 3.56 rad, are 0.178 rad.
  const std::string head = "image,q1,q2,q3\na.png,0,0,0\n";
  EXPECT_EQ(errorOf(head + "b.png,0,1.95,0\n"), "no error");
  EXPECT_NE(errorOf(head + "b.png,0,1.97,0\n"), "no error");
}

TEST_F(Samples, WithoutLimitsDegreesAreSuspectedOnlyInMostJoints) {
  arm_ = test::smallArm(false);
  const std::string head = "image,q1,q2,q3\na.png,0,0,0\n";
  EXPECT_EQ(errorOf(head + "b.png,30,1,0\n"), "no error") << "one joint may turn round and round";
  EXPECT_THAT(errorOf(head + "b.png,30,45,0\n"),
              EndsWith("samples.csv:3: q1 is 30, and 2 of 2 joints are beyond a full turn, expected radians; are the "
                       "readings in degrees?"));
}

TEST_F(Samples, DataThatSupportNothingAreRefused) {
  const auto insufficient = [&](const std::string& content) { return test::messageOf<InsufficientData>([&] { read(content); }); };
  EXPECT_THAT(insufficient("image,q1,q2,q3\n"), EndsWith("samples.csv: no rows, expected one per pose"));
  EXPECT_THAT(insufficient("image,q1,q2,q3\na,1,1,0\nb,1,1,0\n"),
              EndsWith("all 2 rows have the same joint readings, expected poses that differ"));
  EXPECT_THAT(insufficient("image,x,y,z,qx,qy,qz,qw\na,1,1,0,0,0,0,1\nb,1,1,0,0,0,0,-1\n"), HasSubstr("the same flange pose"));
  EXPECT_EQ(insufficient("image,q1,q2,q3\na,1,1,0\n"), "no error") << "one row is a file, if a short one";
  EXPECT_EQ(insufficient("image,q1,q2,q3\na,1,1,0\nb,1,1.001,0\n"), "no error");
}

TEST_F(Samples, RowsOfOnePoseAreOneGroup) {
  const SampleTable table = read("image,q1,q2,q3,pose\na,0,0,0,5\nb,1,0,0,2\nc,0,0,0,5\nd,1,1,0,\ne,1,1.1,0,\nf,1,0,0,2\n");
  EXPECT_THAT(poseGroups(table.samples), ElementsAre(ElementsAre(0, 2), ElementsAre(1, 5), ElementsAre(3), ElementsAre(4)));
}

TEST_F(Samples, EqualReadingsWithoutAPoseColumnAreOneGroup) {
  const SampleTable joints = read("image,q1,q2,q3\na,0,0,0\nb,1,0,0\nc,0.0000009,0,0\nd,1,0.000002,0\ne,0,0,0\n");
  EXPECT_THAT(poseGroups(joints.samples), ElementsAre(ElementsAre(0, 2, 4), ElementsAre(1), ElementsAre(3)));
  const SampleTable poses = read("image,x,y,z,qx,qy,qz,qw\na,1,1,0,0,0,0,1\nb,1,1,0,0,0,0,-1\nc,1,1,0,0,0.6,0,0.8\n");
  EXPECT_THAT(poseGroups(poses.samples), ElementsAre(ElementsAre(0, 1), ElementsAre(2)));
}

TEST_F(Samples, TablesOfJointsAndOfWantedPosesAreHeldToTheArmToo) {
  const auto errorOfJoints = [this](const std::string& content) {
    return test::messageOf<FileError>([&] { readJoints(folder_.write("joints.csv", content), arm_); });
  };
  EXPECT_THAT(errorOfJoints("axis_1,axis_2,axis_3\n0,0,0\n"),
              HasSubstr("joints.csv:1: no joint readings, expected columns q1 to q3; rename"));
  EXPECT_THAT(errorOfJoints("q1,q2,q3,payload\n0,0,0,2500\n"), HasSubstr("joints.csv:2: payload is 2500"));
  const auto errorOfWanted = [this](const std::string& content) {
    return test::messageOf<FileError>([&] { readWantedPoses(folder_.write("wanted.csv", content), arm_); });
  };
  EXPECT_THAT(errorOfWanted("x,y,z,roll,pitch,yaw\n0,0,0,0,0,0\n"), HasSubstr("wanted.csv:1: columns roll, pitch, yaw are not read"));
  EXPECT_THAT(errorOfWanted("x,y,z,qx,qy,qz,qw,payload\n0,0,0,0,0,0,1,2500\n"), HasSubstr("wanted.csv:2: payload is 2500"));
}

TEST_F(Samples, ASlowMotionIsNotOnePose) {
  std::string text = "image,q1,q2,q3\n";
  for (int k = 0; k < 10; ++k) text += fmt::format("{},{},0,0\n", k, 0.4e-6 * k);
  // Each of three rows within 1e-6 of the first of them; chained, all ten would be one.
  EXPECT_EQ(poseGroups(read(text + "x,1,0,0\n").samples).size(), 5u);
}

}  // namespace
}  // namespace poecal
