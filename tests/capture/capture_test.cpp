#include "poecal/capture/capture.hpp"

#include <gmock/gmock.h>

#include "capture/test_arm.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRobot = R"(format: poecal-robot/1
name: two
joints:
- {name: joint_1, type: revolute, axis: [0, 0, 1], point: [0, 0, 0], limits: [-2, 2]}
- {name: joint_2, type: revolute, axis: [0, 1, 0], point: [0, 0, 0.4], limits: [-2, 2]}
flange: {position: [0, 0, 1], quaternion_xyzw: [0, 0, 0, 1]}
)";
constexpr const char* kCamera = R"(image_width: 640
image_height: 480
camera_name: cell
camera_matrix: {rows: 3, cols: 3, data: [600, 0, 320, 0, 600, 240, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}
)";
constexpr const char* kHead = "format: poecal-capture/1\nname: cell\nsetup: eye_to_hand\n";
constexpr const char* kFiles = "robot: robot.yaml\ncamera: camera.yaml\ntarget: target.yaml\nsamples: samples.csv\n";

class CaptureFolder : public ::testing::Test {
 protected:
  CaptureFolder() {
    folder_.write("robot.yaml", kRobot);
    folder_.write("camera.yaml", kCamera);
    folder_.write("target.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n- {id: 7, size: 0.08}\n");
    folder_.write("reference.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n- {id: 8, size: 0.08}\n");
    folder_.write("samples.csv", "image,q1,q2\na.png,0,0\nb.png,1,1\n");
    folder_.write("flange.csv", "image,x,y,z,qx,qy,qz,qw\na.png,0,0,0,0,0,0,1\nb.png,1,1,1,0,0,0,1\n");
    folder_.write("detections.csv", "image,tag,corner,u,v\n");
    folder_.write("pictures/a.png", "");
  }
  Capture read(const std::string& manifest) const {
    folder_.write("capture.yaml", manifest);
    return readCapture(folder_.path());
  }
  std::string errorOf(const std::string& manifest) const {
    return test::messageOf<FileError>([&] { read(manifest); });
  }
  test::TempFolder folder_;
};

TEST_F(CaptureFolder, ReadsAllThatTheManifestNames) {
  const Capture capture =
      read(std::string(kHead) + kFiles + "detections: detections.csv\nreference: reference.yaml\ngravity: [0, 0, -9.8]\n");
  EXPECT_EQ(capture.name, "cell");
  EXPECT_EQ(capture.setup, Setup::kEyeToHand);
  EXPECT_EQ(capture.arm->jointCount(), 2);
  EXPECT_EQ(capture.camera->width, 640);
  EXPECT_EQ(capture.target.points.size(), 4u);
  EXPECT_NE(capture.reference->find({8, 0}), nullptr);
  EXPECT_EQ(capture.detections_file, folder_.path() / "detections.csv");
  EXPECT_EQ(capture.gravity.z(), -9.8);
  EXPECT_EQ(capture.table.samples.size(), 2u);
}

TEST_F(CaptureFolder, WithoutJointsNoRobotIsNeeded) {
  const Capture capture =
      read("format: poecal-capture/1\nname: cell\nsetup: eye_in_hand\nintrinsics: pictures\ntarget: target.yaml\nsamples: flange.csv\n");
  EXPECT_FALSE(capture.arm || capture.camera);
  EXPECT_EQ(capture.intrinsics_folder, folder_.path() / "pictures");
  EXPECT_EQ(capture.setup, Setup::kEyeInHand);
  EXPECT_TRUE(capture.table.has_flange_poses);
  EXPECT_EQ(capture.gravity, Eigen::Vector3d(0, 0, -9.80665));
}

TEST_F(CaptureFolder, ErrorsNameLineAndExpectation) {
  const std::string head = kHead;
  EXPECT_THAT(errorOf("format: poecal-capture/2\n"), HasSubstr("capture.yaml:1: format: is 'poecal-capture/2', expected poecal-capture/1"));
  EXPECT_THAT(errorOf(head + kFiles + "lens: x\n"), HasSubstr("capture.yaml:8: unknown key 'lens'"));
  EXPECT_THAT(errorOf("format: poecal-capture/1\nname: a\nsetup: hand_in_eye\n"),
              HasSubstr("capture.yaml:3: setup: is 'hand_in_eye', expected eye_to_hand or eye_in_hand"));
  EXPECT_THAT(errorOf(head + "robot: none.yaml\n"), HasSubstr("capture.yaml:4: robot: 'none.yaml' is not there, expected a file"));
  EXPECT_THAT(errorOf(head + "robot: robot.yaml\nbase_link: base\n"), HasSubstr("capture.yaml:5: base_link: only a robot that is a URDF"));
  EXPECT_THAT(errorOf(head + "robot: robot.yaml\ntarget: target.yaml\n"),
              HasSubstr("key 'camera' is missing, expected it, or 'intrinsics'"));
  EXPECT_THAT(errorOf(head + kFiles + "intrinsics: pictures\n"), HasSubstr("capture.yaml:8: intrinsics: stands beside camera"));
  EXPECT_THAT(errorOf(head + "robot: robot.yaml\nintrinsics: none\n"),
              HasSubstr("capture.yaml:5: intrinsics: 'none' is not there, expected a folder"));
  EXPECT_THAT(errorOf(head + kFiles + "reference: target.yaml\n"), HasSubstr("capture.yaml:8: reference: tag 7 is the target's too"));
  EXPECT_THAT(errorOf(head + kFiles + "gravity: [0, 0]\n"), HasSubstr("capture.yaml:8: gravity: 2 numbers, expected 3"));
  for (const char* gravity : {"[0, 0, -981]", "[0, 0, -1]", "[0, 0, 0]", "[-9.8, 0, -9.8]"}) {
    EXPECT_THAT(errorOf(head + kFiles + "gravity: " + gravity + "\n"),
                AllOf(HasSubstr("capture.yaml:8: gravity: has length "), HasSubstr("expected 9.8: gravity in the base frame [m/s^2]")));
  }
  EXPECT_EQ(errorOf(head + kFiles + "gravity: [6.93, 0, 6.93]\n"), "no error") << "an arm on a slope, upside down";
  EXPECT_THAT(errorOf(head + "camera: camera.yaml\ntarget: target.yaml\nsamples: samples.csv\n"),
              HasSubstr("key 'robot' is missing, expected the arm whose joints samples.csv gives"));
  EXPECT_THAT(test::messageOf<FileError>([] { readCapture("/nowhere"); }), HasSubstr("/nowhere/capture.yaml: no such file"));
}

TEST_F(CaptureFolder, AUrdfNeedsItsTwoLinks) {
  folder_.write("arm.urdf", "<robot name=\"a\"><link name=\"base\"/></robot>");
  EXPECT_THAT(errorOf(std::string(kHead) + "robot: arm.urdf\nbase_link: base\n"), HasSubstr("key 'tip_link' is missing"));
}

class CaptureReal : public ::testing::TestWithParam<std::pair<const char*, std::size_t>> {};

TEST_P(CaptureReal, Reads) {
  const auto [set, rows] = GetParam();
  POECAL_REQUIRE_REAL(set);
  const Capture capture = readCapture(test::realFolder() / set);
  EXPECT_EQ(capture.table.samples.size(), rows);
  EXPECT_TRUE(capture.table.has_flange_poses);
}

INSTANTIATE_TEST_SUITE_P(Sets, CaptureReal,
                         ::testing::Values(std::pair("irb2400-charuco", 16u), std::pair("fr3-charuco", 35u),
                                           std::pair("panda-apriltag", 8u)));

}  // namespace
}  // namespace poecal
