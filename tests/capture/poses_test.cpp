#include <gmock/gmock.h>

#include "capture/test_arm.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Poses : public ::testing::Test {
 protected:
  PoseTable read(const std::string& content) const { return readPoses(folder_.write("poses.csv", content), test::smallArm()); }
  std::string errorOf(const std::string& content) const {
    return test::messageOf<FileError>([&] { read(content); });
  }
  test::TempFolder folder_;
};

TEST_F(Poses, FullPosesWithTheirDeviations) {
  const PoseTable table = read(
      "q1,q2,q3,x,y,z,qx,qy,qz,qw,sigma_position,sigma_rotation,pose,humidity\n"
      "0,0,0,1,2,3,0,0,0,1,1e-4,2e-4,7,40\n0,1,0,1,2,3,0,0,1,0,,,8,41\n");
  EXPECT_FALSE(table.position_only);
  EXPECT_EQ(table.poses[0].sigma_position, 1e-4);
  EXPECT_EQ(table.poses[0].sigma_rotation, 2e-4);
  EXPECT_EQ(table.poses[1].sigma_position, std::nullopt);
  EXPECT_EQ(table.poses[1].sample.pose, 8);
  EXPECT_FALSE(table.poses[0].sample.T_base_flange) << "the measured pose is not the controller's";
  EXPECT_THAT(Eigen::Vector3d(table.poses[1].T_instrument_tool * Eigen::Vector3d(1, 0, 0)), test::IsNear(Eigen::Vector3d(0, 2, 3), 1e-15));
  EXPECT_THAT(table.other_columns, ElementsAre("humidity"));
}

TEST_F(Poses, PositionsAlone) {
  const PoseTable table = read("q1,q2,q3,x,y,z\n0,0,0,1,2,3\n0,1,0,1,2,4\n");
  EXPECT_TRUE(table.position_only && table.poses[0].position_only);
  EXPECT_THAT(table.poses[1].T_instrument_tool.matrix(),
              test::IsNear(Eigen::Matrix4d(Eigen::Affine3d(Eigen::Translation3d(1, 2, 4)).matrix()), 0.0));
}

TEST_F(Poses, ErrorsNameLineAndExpectation) {
  EXPECT_THAT(errorOf("x,y,z\n1,2,3\n"), HasSubstr("poses.csv:1: no joint readings, expected columns q1 to q3"));
  for (const char* names :
       {"rx,ry,rz", "roll,pitch,yaw", "Yaw,Pitch,Roll", "A,B,C", "W,P,R", "rot_x,rot_y,rot_z", "rx_deg,ry_deg,rz_deg", "QX,QY,QZ"}) {
    EXPECT_THAT(errorOf(std::string("q1,q2,q3,x,y,z,") + names + "\n0,0,0,1,2,3,0,0,0\n0,1,0,1,2,3,0,0,0\n"),
                HasSubstr("are not read, expected the orientation as a quaternion in qx, qy, qz, qw"))
        << names;
  }
  EXPECT_EQ(read("q1,q2,q3,x,y,z,humidity,rx\n0,0,0,1,2,3,4,5\n0,1,0,1,2,3,4,6\n").other_columns.size(), 2u);
  EXPECT_THAT(errorOf("q1,q2,q3,x,z\n0,0,0,1,2\n"), HasSubstr("poses.csv:1: column 'y' is missing"));
  EXPECT_THAT(errorOf("q1,q2,q3,x,y,z,qx,qy\n0,0,0,1,2,3,0,0\n"), HasSubstr("poses.csv:1: column 'qz' is missing"));
  EXPECT_THAT(errorOf("q1,q2,q3,x,y,z,sigma_position\n0,0,0,1,2,3,0\n"),
              HasSubstr("poses.csv:2: sigma_position is 0, expected a positive number"));
  EXPECT_THAT(errorOf("q1,q2,q3,x,y,z\n0,90,0,1,2,3\n"), HasSubstr("are the readings in degrees?"));
  EXPECT_THAT(test::messageOf<InsufficientData>([&] { read("q1,q2,q3,x,y,z\n0,1,0,1,2,3\n0,1,0,1,2,4\n"); }),
              HasSubstr("same joint readings"));
}

TEST(PosesReal, PublishedSetsRead) {
  POECAL_REQUIRE_REAL("franka-board");
  POECAL_REQUIRE_REAL("positioner");
  for (const auto& [set, rows] : {std::pair("franka-board", 114u), std::pair("positioner", 205u)}) {
    const std::filesystem::path folder = test::realFolder() / set;
    EXPECT_EQ(readPoses(folder / "poses.csv", readRobotYaml(folder / "robot.yaml")).poses.size(), rows);
  }
}

}  // namespace
}  // namespace poecal
