#include "camera/camera_yaml.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "camera/camera_examples.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

constexpr const char* kRosYaml = R"(image_width: 640
image_height: 480
camera_name: left
camera_matrix:
  rows: 3
  cols: 3
  data: [536.07, 0.0, 342.37, 0.0, 536.02, 235.54, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.265, -0.047, 0.0018, -0.0003, 0.252]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
projection_matrix:
  rows: 3
  cols: 4
  data: [530.0, 0.0, 342.37, 0.0, 0.0, 530.0, 235.54, 0.0, 0.0, 0.0, 1.0, 0.0]
)";

/// kRosYaml with one piece replaced.
std::string edited(const std::string& from, const std::string& to) {
  std::string text = kRosYaml;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CameraYaml, ReadsWhatRosWrites) {
  const test::TempFolder folder;
  const Camera camera = readCamera(folder.write("camera.yaml", kRosYaml));
  EXPECT_EQ(camera.name, "left");
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.model, DistortionModel::kPlumbBob);
  Eigen::VectorXd expected(9);
  expected << 536.07, 536.02, 342.37, 235.54, -0.265, -0.047, 0.0018, -0.0003, 0.252;
  EXPECT_EQ(camera.parameters(), expected);
  EXPECT_EQ(camera.standard_deviation.size(), 0);
}

TEST(CameraYaml, WritingThenReadingGivesTheSameBits) {
  const test::TempFolder folder;
  for (Camera camera : test::exampleCameras()) {
    camera.name = "cell 3: left";
    camera.fx = 100.0 * M_PI;
    camera.standard_deviation = Eigen::VectorXd::Constant(camera.parameterCount(), 0.1 / 3.0);
    camera.standard_deviation(2) = std::numeric_limits<double>::quiet_NaN();
    const Camera back = readCamera(folder.write("camera.yaml", cameraYaml(camera)));
    EXPECT_EQ(back.name, camera.name);
    EXPECT_EQ(back.width, camera.width);
    EXPECT_EQ(back.height, camera.height);
    EXPECT_EQ(back.model, camera.model);
    EXPECT_EQ(back.parameters(), camera.parameters());
    EXPECT_TRUE(std::isnan(back.standard_deviation(2)));
    EXPECT_EQ(back.standard_deviation.tail(camera.parameterCount() - 3), camera.standard_deviation.tail(camera.parameterCount() - 3));
  }
}

TEST(CameraYaml, IsAMapOfALargerFileToo) {
  const test::TempFolder folder;
  const Camera camera = test::rationalCamera();
  const auto file = folder.write("model.yaml", "robot: none\ncamera:\n" + cameraYamlBlock(camera, 2));
  EXPECT_EQ(parseCamera(YamlNode::load(file)["camera"]).parameters(), camera.parameters());
}

TEST(CameraYaml, CoefficientsThatAreNotStatedAreZeroAndWrittenOut) {
  const test::TempFolder folder;
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(5);
  const std::string five = "  cols: 5\n  data: [-0.265, -0.047, 0.0018, -0.0003, 0.252]";
  EXPECT_EQ(readCamera(folder.write("none.yaml", edited(five, "  cols: 0\n  data: []"))).distortion, expected);
  expected.head(4) << -0.265, -0.047, 0.0018, -0.0003;
  EXPECT_EQ(readCamera(folder.write("four.yaml", edited(five, "  cols: 4\n  data: [-0.265, -0.047, 0.0018, -0.0003]"))).distortion,
            expected);
  EXPECT_THAT(cameraYaml(test::makeCamera(DistortionModel::kEquidistant, {0.5})), HasSubstr("data: [0.5, 0.0, 0.0, 0.0]"));
}

TEST(CameraYaml, ReadsTheFilesOfTheRealCaptures) {
  for (const char* set : {"fr3-charuco", "irb2400-charuco", "panda-apriltag"}) {
    POECAL_REQUIRE_REAL(set);
    EXPECT_EQ(readCamera(test::realFolder() / set / "camera.yaml").parameterCount(), 9) << set;
  }
}

constexpr const char* kK = "[536.07, 0.0, 342.37, 0.0, 536.02, 235.54, 0.0, 0.0, 1.0]";
constexpr const char* kD = "[-0.265, -0.047, 0.0018, -0.0003, 0.252]";

/// The lens of kRosYaml as other programs write it.
std::vector<std::string> otherForms() {
  const std::string k = kK, d = kD;
  const std::string size = "image_width: 640\nimage_height: 480\n";
  const std::string k_map = "   rows: 3\n   cols: 3\n   dt: d\n   data: " + k + "\n";
  const std::string column = "   rows: 5\n   cols: 1\n   dt: d\n   data: " + d + "\n";
  return {
      // ros2 topic echo --once, and rostopic echo.
      "header:\n  stamp:\n    sec: 17\n    nanosec: 83\n  frame_id: left\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nd:\n- "
      "-0.265\n- "
      "-0.047\n- 0.0018\n- -0.0003\n- 0.252\nk: " +
          k +
          "\nr:\n- 1\n- 0\n- 0\n- 0\n- 1\n- 0\n- 0\n- 0\n- 1\np: [536, 0, 342, 0, 0, 536, 235, 0, 0, 0, 1, "
          "0]\nbinning_x: 0\nbinning_y: 0\nroi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n  do_rectify: false\n---\n",
      "header: \n  seq: 4\n  stamp: \n    secs: 1\n    nsecs: 2\n  frame_id: \"left\"\nheight: 480\nwidth: 640\ndistortion_model: "
      "\"plumb_bob\"\nD: " +
          d + "\nK: " + k +
          "\nR: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\nbinning_x: 1\nbinning_y: 1\nroi: \n  x_offset: 0\n  y_offset: 0\n  height: "
          "480\n  width: 640\n  do_rectify: False\n",
      // cv::FileStorage: OpenCV 2's header without ---, a column of coefficients, what its sample adds; and as JSON.
      "%YAML:1.0\n---\n" + size + "camera_matrix: !!opencv-matrix\n" + k_map + "distortion_coefficients: !!opencv-matrix\n" + column +
          "avg_reprojection_error: 2.0e-01\nflags: 2\n",
      "%YAML:1.0\nimage_Width: 640\nimage_Height: 480\nCamera_Matrix: !!opencv-matrix\n" + k_map +
          "Distortion_Coefficients: !!opencv-matrix\n" + column,
      "{\"cameraResolution\": [640, 480], \"cameraMatrix\": {\"type_id\": \"opencv-matrix\", \"rows\": 3, \"cols\": 3, \"dt\": \"d\", "
      "\"data\": " +
          k + "}, \"dist_coeffs\": " + d + "}",
      // numpy's lists.
      size + "K: [[536.07, 0, 342.37], [0, 536.02, 235.54], [0, 0, 1]]\nD: [" + d + "]\n",
      size +
          "camera_matrix:\n- [536.07, 0, 342.37]\n- [0, 536.02, 235.54]\n- [0, 0, 1]\ndist_coeff: [[-0.265], [-0.047], [0.0018], "
          "[-0.0003], [0.252]]\n",
      // OpenCV's further coefficients, of which none is used.
      edited("  cols: 5\n  data: " + d, "  cols: 14\n  data: [-0.265, -0.047, 0.0018, -0.0003, 0.252, 0, 0, 0, 0, 0, 0, 0, 0, 0]"),
      edited("  cols: 5\n  data: " + d, "  cols: 8\n  data: [-0.265, -0.047, 0.0018, -0.0003, 0.252, 0, 0, 0]"),
      edited("image_width: 640", "image_width: 640.0"),
  };
}

TEST(CameraYaml, ReadsTheSameLensInEveryFormThatPeopleHave) {
  const test::TempFolder folder;
  const Camera expected = readCamera(folder.write("camera.yaml", kRosYaml));
  for (const std::string& text : otherForms()) {
    const Camera camera = readCamera(folder.write("camera.yaml", text));
    EXPECT_EQ(camera.model, expected.model) << text;
    EXPECT_EQ(camera.parameters(), expected.parameters()) << text;
    EXPECT_EQ(camera.width, 640) << text;
    EXPECT_EQ(camera.height, 480) << text;
  }
}

TEST(CameraYaml, ReadsKalibrsCamchain) {
  const test::TempFolder folder;
  const std::string chain =
      "cam0:\n  cam_overlaps: []\n  camera_model: pinhole\n  distortion_coeffs: [-0.013, 0.021, -0.012, 0.0021]\n  distortion_model: "
      "equidistant\n  intrinsics: [190, 191.5, 325.25, 236.5]\n  resolution: [640, 480]\n  rostopic: /cam/image_raw\n";
  const Camera fisheye = readCamera(folder.write("camchain.yaml", chain));
  Eigen::VectorXd expected(8);
  expected << 190.0, 191.5, 325.25, 236.5, -0.013, 0.021, -0.012, 0.0021;
  EXPECT_EQ(fisheye.model, DistortionModel::kEquidistant);
  EXPECT_EQ(fisheye.parameters(), expected);
  EXPECT_EQ(fisheye.width, 640);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = chain;
    return folder.write("camchain.yaml", text.replace(text.find(from), from.size(), to));
  };
  const Camera radtan = readCamera(with("equidistant", "radtan"));
  EXPECT_EQ(radtan.model, DistortionModel::kPlumbBob);
  EXPECT_EQ(radtan.distortion(2), -0.012) << "p1, and k3 is zero";
  EXPECT_EQ(radtan.distortion(4), 0.0);
  EXPECT_THAT([&] { readCamera(with("pinhole", "omni")); },
              ThrowsMessage<FileError>(HasSubstr("camera_model: is 'omni', expected pinhole")));
  const auto two = folder.write("camchain.yaml", chain + "cam1:\n" + chain.substr(6));
  EXPECT_THAT([&] { readCamera(two); }, ThrowsMessage<FileError>(HasSubstr("2 cameras (cam0, cam1), expected one")));
}

TEST(CameraYaml, CoefficientsSayWhichModelTheyAre) {
  const test::TempFolder folder;
  const std::string five = "  cols: 5\n  data: [-0.265, -0.047, 0.0018, -0.0003, 0.252]";
  const auto read = [&](const std::string& count, const std::string& data, const std::string& model) {
    std::string text = edited(five, "  cols: " + count + "\n  data: [" + data + "]");
    text.replace(text.find("plumb_bob"), 9, model);
    return readCamera(folder.write("camera.yaml", text));
  };
  EXPECT_EQ(read("8", "1, 2, 0, 0, 3, 4, 5, 6", "plumb_bob").model, DistortionModel::kRationalPolynomial);
  EXPECT_EQ(read("5", "1, 2, 0, 0, 3", "rational_polynomial").model, DistortionModel::kRationalPolynomial);
  EXPECT_EQ(read("12", "1, 2, 0, 0, 3, 4, 5, 6, 0, 0, 0, 0", "rational_polynomial").model, DistortionModel::kRationalPolynomial);
  const Camera prism = read("14", "1, 2, 0, 0, 3, 4, 5, 6, 0.01, 0, 0.02, 0, 0, 0", "rational_polynomial");
  EXPECT_EQ(prism.model, DistortionModel::kThinPrism);
  EXPECT_EQ(prism.distortion(10), 0.02);
  EXPECT_EQ(read("5", "1, 2, 3, 4, 0", "fisheye").distortion.size(), 4);
  EXPECT_THAT([&] { read("14", "1, 2, 0, 0, 3, 4, 5, 6, 0, 0, 0, 0, 0.01, 0", "plumb_bob"); },
              ThrowsMessage<FileError>(HasSubstr("tau_x and tau_y, tilt the sensor")));
  EXPECT_THAT([&] { read("6", "1, 2, 0, 0, 3, 4", "plumb_bob"); },
              ThrowsMessage<FileError>(HasSubstr("6 coefficients, expected 4, 5, 8, 12 or 14 for plumb_bob")));
}

TEST(CameraYaml, TheSizeMayBeThePictures) {
  const test::TempFolder folder;
  const auto file = folder.write("camera.yaml", std::string("K: ") + kK + "\nD: " + kD + "\n");
  const Camera camera = readCameraOfPictures(file);
  EXPECT_EQ(camera.fx, 536.07);
  EXPECT_EQ(camera.width, 0);
  EXPECT_EQ(camera.height, 0);
  EXPECT_THAT([&] { readCamera(file); }, ThrowsMessage<FileError>(HasSubstr("key 'image_width' is missing")));
  const auto half = folder.write("camera.yaml", std::string("width: 640\nK: ") + kK + "\nD: " + kD + "\n");
  EXPECT_THAT([&] { readCameraOfPictures(half); }, ThrowsMessage<FileError>(HasSubstr("key 'image_height' is missing")));
}

TEST(CameraYaml, WhatIsNotKeptIsSaid) {
  const test::TempFolder folder;
  EXPECT_THAT(readCamera(folder.write("camera.yaml", kRosYaml)).remarks, IsEmpty());
  const Camera skewed = readCamera(folder.write("camera.yaml", edited("[536.07, 0.0", "[536.07, -0.5")));
  EXPECT_EQ(skewed.fx, 536.07);
  EXPECT_THAT(skewed.remarks, ElementsAre("skew -0.5 is dropped: it moves the picture's top by 0.45 px against its bottom"));
  const std::string text = std::string("image_width: 640\nimage_height: 480\nK: ") + kK + "\nD: [0.1, 0, 0, 0]\nrms: 0.2\n";
  EXPECT_THAT(readCamera(folder.write("camera.yaml", text)).remarks,
              ElementsAre(HasSubstr("a fisheye's need distortion_model: equidistant"), "not read: rms"));
}

TEST(CameraYaml, APrincipalPointOutsideThePictureIsSaid) {
  const test::TempFolder folder;
  EXPECT_THAT(readCamera(folder.write("camera.yaml", kRosYaml)).remarks, IsEmpty());
  EXPECT_THAT(readCamera(folder.write("camera.yaml", edited("342.37, 0.0, 536.02", "700, 0.0, 536.02"))).remarks,
              ElementsAre("its principal point (700, 236) px is outside the picture of 640 x 480 px, expected it near the middle"));
  EXPECT_THAT(readCamera(folder.write("camera.yaml", edited("342.37, 0.0, 536.02", "200, 0.0, 536.02"))).remarks, IsEmpty())
      << "cut from a larger picture";
}

struct BadFile {
  const char* from;
  const char* to;
  const char* message;
};

class CameraYamlErrors : public testing::TestWithParam<BadFile> {};

TEST_P(CameraYamlErrors, NameTheLineAndWhatWasExpected) {
  const test::TempFolder folder;
  const auto file = folder.write("camera.yaml", edited(GetParam().from, GetParam().to));
  EXPECT_THAT([&] { readCamera(file); }, ThrowsMessage<FileError>(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Files, CameraYamlErrors,
    testing::Values(
        BadFile{"image_width: 640", "image_width: 0", "camera.yaml:1: image_width: is 0, expected a positive number of pixels"},
        BadFile{
            "image_width: 640\nimage_height: 480", "image_width: 480\nimage_height: 640",
            "camera.yaml:7: camera_matrix.data: the principal point (342.37, 235.54) is the middle of a picture of 640 x 480 px, not of "
            "480 x 640: expected a lens and a picture size of one camera; are width and height exchanged?"},
        BadFile{"342.37, 0.0, 536.02", "3423.7, 0.0, 536.02",
                "camera.yaml:7: camera_matrix.data: the principal point (3423.7, 235.54) is far outside of the picture of 640 x 480 px"},
        BadFile{"image_height: 480\n", "", "key 'image_height' is missing"},
        BadFile{"camera_name", "kamera_name", "camera.yaml:3: unknown key 'kamera_name'"},
        BadFile{
            "[536.07, 0.0", "[536.07, 1.5",
            "camera.yaml:7: camera_matrix.data: skew 1.5 moves the picture's top by 1.3 px against its bottom, expected less than 1 px"},
        BadFile{"[536.07", "[-536.07", "camera.yaml:7: camera_matrix.data: focal lengths -536.07 and 536.02, expected positive"},
        BadFile{"235.54, 0.0, 0.0, 1.0]", "235.54, 0.0, 0.0, 2.0]",
                "camera.yaml:7: camera_matrix.data: expected [fx, 0, cx, 0, fy, cy, 0, 0, 1]"},
        BadFile{"235.54, 0.0, 0.0, 1.0]", "235.54, 0.0, 0.0]",
                "camera.yaml:7: camera_matrix.data: 8 numbers, expected rows * cols = 3 * 3"},
        BadFile{"plumb_bob", "mei",
                "camera.yaml:8: distortion_model: is 'mei', expected one of: plumb_bob, rational_polynomial, equidistant, thin_prism"},
        BadFile{"image_width: 640", "image_width: 640.5", "camera.yaml:1: image_width: is 640.5, expected a positive number of pixels"},
        BadFile{"image_width: 640", "width: 640\nimage_width: 640", "camera.yaml:1: width: stands beside image_width"},
        BadFile{"-0.0003, 0.252]", "-0.0003]\n  dt: 3", "4 numbers, expected rows * cols = 1 * 5"},
        BadFile{"rectification_matrix", "binning_x: 2\nrectification_matrix", "camera.yaml:13: binning_x: the pictures are binned"},
        BadFile{"rectification_matrix", "roi: {x_offset: 8, y_offset: 0, width: 320, height: 240}\nrectification_matrix",
                "camera.yaml:13: roi: the pictures are a part"},
        BadFile{"plumb_bob", "equidistant",
                "camera.yaml:12: distortion_coefficients.data: 5 coefficients, expected 4 for equidistant (or none)"},
        BadFile{"cols: 4", "cols: 3", "camera.yaml:20: projection_matrix.data: 12 numbers, expected rows * cols = 3 * 3"},
        BadFile{"rectification_matrix", "standard_deviation: {fx: -1.0}\nrectification_matrix",
                "camera.yaml:13: standard_deviation.fx: is -1.0, expected"},
        BadFile{"rectification_matrix", "standard_deviation: {k4: 0.1}\nrectification_matrix",
                "camera.yaml:13: standard_deviation.k4: plumb_bob has no coefficient of this name"},
        BadFile{"rectification_matrix", "standard_deviation: {skew: 0.1}\nrectification_matrix", "camera.yaml:13: unknown key 'skew'"}));

}  // namespace
}  // namespace poecal
