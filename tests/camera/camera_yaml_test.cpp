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

using testing::HasSubstr;
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
        BadFile{"image_height: 480\n", "", "key 'image_height' is missing"},
        BadFile{"camera_name", "kamera_name", "camera.yaml:3: unknown key 'kamera_name'"},
        BadFile{"[536.07, 0.0", "[536.07, 0.1", "camera.yaml:7: camera_matrix.data: skew 0.1, expected 0"},
        BadFile{"[536.07", "[-536.07", "camera.yaml:7: camera_matrix.data: focal lengths -536.07 and 536.02, expected positive"},
        BadFile{"235.54, 0.0, 0.0, 1.0]", "235.54, 0.0, 0.0, 2.0]",
                "camera.yaml:7: camera_matrix.data: expected [fx, 0, cx, 0, fy, cy, 0, 0, 1]"},
        BadFile{"235.54, 0.0, 0.0, 1.0]", "235.54, 0.0, 0.0]",
                "camera.yaml:7: camera_matrix.data: 8 numbers, expected rows * cols = 3 * 3"},
        BadFile{"plumb_bob", "fisheye",
                "camera.yaml:8: distortion_model: is 'fisheye', expected one of: plumb_bob, rational_polynomial, equidistant"},
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
