#include "poecal/simulation/scene.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "simulation/scene_files.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::kSceneHead;
using test::smallScene;
using test::TempFolder;
using testing::HasSubstr;

std::string errorOf(const std::string& rest) {
  const TempFolder folder;
  try {
    smallScene(folder, rest);
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Scene, DefaultsArePicturesOfSixtyPosesOfTheNominalArm) {
  const TempFolder folder;
  const Scene scene = smallScene(folder, "");
  EXPECT_EQ(scene.name, "small");
  EXPECT_EQ(scene.count, 60);
  EXPECT_EQ(scene.repeats, 1);
  ASSERT_TRUE(scene.image.has_value());
  EXPECT_EQ(scene.image->background, "clutter");
  EXPECT_FALSE(scene.corner_sigma.has_value());
  EXPECT_FALSE(scene.board.has_value());
  EXPECT_EQ(scene.stated_camera.fx, scene.camera.fx);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_THAT(scene.actual.joints[k].xi, test::IsNear(scene.nominal.joints[k].xi, 0.0));
}

TEST(Scene, ReadsEveryKey) {
  const TempFolder folder;
  const Scene scene = smallScene(folder,
                                 "stated: stated.yaml\nstated_target: larger.yaml\nerrors: {seed: 4, position: 1.0e-3, rotation: 2.0e-3}\n"
                                 "samples: {count: 5, seed: 9, repeats: 3}\neffects: []\n"
                                 "image: {blur: 0.5, noise: 1.5, background: plain}\nintrinsics: {target: board.yaml, count: 4}\n");
  EXPECT_EQ(scene.camera.fx, 400.0);
  EXPECT_EQ(scene.stated_camera.fx, 404.0);
  EXPECT_EQ(scene.target.tags.front().size, 0.1);
  EXPECT_EQ(scene.stated_target.tags.front().size, 0.101);
  EXPECT_EQ(scene.count, 5);
  EXPECT_EQ(scene.seed, 9u);
  EXPECT_EQ(scene.repeats, 3);
  EXPECT_EQ(scene.image->blur, 0.5);
  EXPECT_EQ(scene.image->noise, 1.5);
  EXPECT_EQ(scene.image->background, "plain");
  ASSERT_TRUE(scene.board.has_value());
  EXPECT_EQ(scene.board->type, TargetType::kChessboard);
  EXPECT_EQ(scene.board_count, 4);
  EXPECT_THAT(Eigen::Vector3d(scene.registration.T_camera_near.translation()), test::IsNear(Eigen::Vector3d(0, 0, 0.7), 0.0));
}

TEST(Scene, EyeInHandNamesItsOwnTransforms) {
  const TempFolder folder;
  test::writeScene(folder, "");
  const std::string pose = "{position: [0, 0, 0.1], quaternion_xyzw: [0, 0, 0, 1]}";
  const std::string head = "format: poecal-scene/1\nsetup: eye_in_hand\nrobot: robot.yaml\ncamera: camera.yaml\ntarget: target.yaml\n";
  const Scene scene =
      readScene(folder.write("hand.yaml", head + "registration: {T_camera_flange: " + pose + ", T_base_target: " + pose + "}\n"));
  EXPECT_EQ(scene.registration.setup, poecal::Setup::kEyeInHand);
  EXPECT_EQ(scene.name, "hand");
  EXPECT_THROW(readScene(folder.write("wrong.yaml", head + "registration: {T_camera_base: " + pose + ", T_flange_target: " + pose + "}\n")),
               FileError);
}

TEST(Scene, ErrorsHaveTheStatedStandardDeviations) {
  // Per revolute joint the direction turns by two normal angles, so the square of the angle has the mean 2 sigma^2; likewise the shift of
  // the axis.
  const TempFolder folder;
  constexpr int kSeeds = 200;
  constexpr double kRotation = 2e-3, kPosition = 6e-4;
  std::vector<double> angles, shifts, slide_angles;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Scene scene = smallScene(folder, "errors: {seed: " + std::to_string(seed) + ", position: 6.0e-4, rotation: 2.0e-3}\n");
    for (std::size_t k = 0; k < 3; ++k) {
      const Joint &nominal = scene.nominal.joints[k], &actual = scene.actual.joints[k];
      const double angle = std::asin(nominal.axis().cross(actual.axis()).norm());
      if (actual.type == JointType::kPrismatic) {
        slide_angles.push_back(angle);
        continue;
      }
      angles.push_back(angle);
      // Distance of the nominal anchor from the actual axis: v = -w x p for every point p of it.
      const Eigen::Vector3d w = actual.axis(), v = actual.xi.tail<3>();
      shifts.push_back((v + w.cross(nominal.anchor)).norm());
    }
  }
  // The mean of N squares of two normals varies by 1/sqrt(N), their root by half of that: four of these.
  const auto tolerance = [](std::size_t count) { return 4.0 * 0.5 / std::sqrt(static_cast<double>(count)); };
  EXPECT_NEAR(rms(angles) / (std::sqrt(2.0) * kRotation), 1.0, tolerance(angles.size()));
  EXPECT_NEAR(rms(shifts) / (std::sqrt(2.0) * kPosition), 1.0, tolerance(shifts.size()));
  EXPECT_NEAR(rms(slide_angles) / (std::sqrt(2.0) * kRotation), 1.0, tolerance(slide_angles.size()));
}

TEST(Scene, ActualArmFromAFile) {
  const TempFolder folder;
  folder.write("actual.yaml", R"(format: poecal-robot/1
name: true
joints:
  - {name: swivel, type: revolute, axis: [0, 0, 1], point: [0.051, 0, 0]}
  - {name: nod, type: revolute, axis: [1, 0, 0], point: [0, 0.03, 0]}
  - {name: slide, type: prismatic, axis: [0, 1, 0]}
flange: {position: [0, 0, 0.05], quaternion_xyzw: [0, 0, 0, 1]}
)");
  const Scene scene = smallScene(folder, "actual: actual.yaml\n");
  EXPECT_THAT(Vector6d(scene.actual.joints[0].xi - scene.nominal.joints[0].xi),
              test::IsNear((Vector6d() << 0, 0, 0, 0, -0.001, 0).finished(), 1e-15));
}

TEST(Scene, ActualArmOfOtherJointsIsAnError) {
  const TempFolder folder;
  const std::string joint = "  - {name: a, type: revolute, axis: [0, 0, 1], point: [0, 0, 0]}\n";
  const std::string flange = "flange: {position: [0, 0, 0.05], quaternion_xyzw: [0, 0, 0, 1]}\n";
  for (const std::string& joints : {joint, joint + joint + joint}) {
    folder.write("actual.yaml", "format: poecal-robot/1\nname: other\njoints:\n" + joints + flange);
    EXPECT_THROW(smallScene(folder, "actual: actual.yaml\n"), FileError);
  }
}

TEST(Scene, ErrorsNameLineAndExpectation) {
  EXPECT_THAT(errorOf("effects: [{effect: joint_gain, location: joint:1}]\n"),
              HasSubstr("scene.yaml:8: effects[0]: key 'parameters' is missing"));
  EXPECT_THAT(errorOf("effects:\n- {effect: joint_gain, location: joint:4, parameters: {gain: 0.1}}\n"),
              HasSubstr("scene.yaml:9: effects[0]: joint_gain cannot be at 'joint:4', expected joint:1 to joint:3"));
  EXPECT_THAT(
      errorOf("effects: [{effect: corner_bias, location: detector, parameters: {outward: 0.1}}]\n"),
      HasSubstr("scene.yaml:8: effects: corner_bias moves single points, which pictures cannot show, expected corners: {sigma: ...}"));
  EXPECT_THAT(errorOf("colour: red\n"), HasSubstr("scene.yaml:8: unknown key 'colour'"));
  EXPECT_THAT(errorOf("samples: {count: 0}\n"), HasSubstr("scene.yaml:8: samples.count: is 0, expected 1 to 1000000"));
  EXPECT_THAT(errorOf("samples: {file: samples.csv}\n"), HasSubstr("scene.yaml:8: samples.file: 'samples.csv' is not there"));
  EXPECT_THAT(errorOf("samples: {file: robot.yaml, count: 3}\n"), HasSubstr("scene.yaml:8: unknown key 'count'"));
  EXPECT_THAT(errorOf("image: {}\ncorners: {sigma: 0.1}\n"), HasSubstr("scene.yaml:9: corners: stands beside image"));
  EXPECT_THAT(errorOf("image: {background: forest}\n"), HasSubstr("scene.yaml:8: image: background 'forest' is not known"));
  EXPECT_THAT(errorOf("image:\n  blur: 0.7\n  like: looks.csv\n"),
              HasSubstr("scene.yaml:10: image.like: stands beside blur, expected one of the two"));
  EXPECT_THAT(errorOf("image: {like: looks.csv, noise: 2}\n"), HasSubstr("scene.yaml:8: image.like: stands beside noise"));
  EXPECT_THAT(errorOf("image: {like: looks.csv}\n"), HasSubstr("scene.yaml:8: image.like: 'looks.csv' is not there"));
  EXPECT_THAT(errorOf("corners: {sigma: -1}\n"), HasSubstr("scene.yaml:8: corners.sigma: is -1.0, expected 0 to 1000.0"));
  EXPECT_THAT(errorOf("errors: {seed: 1, position: 0, rotation: 0}\nactual: robot.yaml\n"),
              HasSubstr("scene.yaml:9: actual: stands beside errors"));
  EXPECT_THAT(errorOf("errors: {seed: 1, position: 0}\n"), HasSubstr("scene.yaml:8: errors: key 'rotation' is missing"));
  EXPECT_THAT(errorOf("setup: eye_on_a_stick\n"), HasSubstr("scene.yaml:8: setup: is 'eye_on_a_stick', expected"));
  EXPECT_THAT(errorOf("corners: {sigma: 0}\nintrinsics: {target: board.yaml, count: 3}\n"),
              HasSubstr("scene.yaml:9: intrinsics: needs pictures"));
  EXPECT_THAT(errorOf("intrinsics: {target: points.yaml, count: 3}\n"),
              HasSubstr("scene.yaml:8: intrinsics.target: single points cannot be drawn"));
}

TEST(Scene, FiguresThatNobodyMeansAreRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"samples: {count: 1000000000}\n", "samples.count: is 1000000000, expected 1 to 1000000"},
      {"samples: {count: 10, repeats: 1000000000}\n", "samples.repeats: is 1000000000, expected 1 to 100000"},
      {"samples: {count: 1000, repeats: 1001}\n", "samples.repeats: is 1001, expected 1 to 1000"},
      {"intrinsics: {target: board.yaml, count: 1000000000}\n", "intrinsics.count: is 1000000000, expected 1 to 10000"},
      {"image: {blur: 1e9}\n", "image.blur: is 1000000000.0, expected 0 to 30.0"},
      {"image: {blur: 31}\n", "image.blur: is 31.0, expected 0 to 30.0"},
      {"image: {noise: 256}\n", "image.noise: is 256.0, expected 0 to 255.0"},
      {"corners: {sigma: 1e20}\n", "corners.sigma: is 1.0e+20, expected 0 to 1000.0"},
      {"errors: {seed: 1, position: 600, rotation: 0}\n", "errors.position: is 600.0, expected 0 to 1.0"},
  };
  for (const auto& [rest, says] : cases) EXPECT_THAT(errorOf(rest), HasSubstr(std::string("scene.yaml:8: ") + says));
  const TempFolder folder;
  folder.write("looks.csv", "blur,noise\n0.7,2\n1000000,2\n");
  EXPECT_THAT(
      [&] { smallScene(folder, "image: {like: looks.csv}\n"); },
      ::testing::Throws<FileError>(::testing::Property(&FileError::what, HasSubstr("looks.csv:3: blur is 1000000.0, expected 0 to 30.0"))));
  test::writeScene(folder, "");
  std::string camera = readTextFile(folder.path() / "camera.yaml");
  camera.replace(camera.find("320"), 3, "20000").replace(camera.find("240"), 3, "20000");
  folder.write("camera.yaml", camera);
  EXPECT_THAT(
      [&] { readScene(folder.path() / "scene.yaml"); },
      ::testing::Throws<FileError>(::testing::Property(&FileError::what, HasSubstr("scene.yaml:4: camera: has 20000 x 20000 pixels"))));
}

TEST(Scene, SinglePointsNeedCornersWithoutPictures) {
  const TempFolder folder;
  test::writeScene(folder, "");
  std::string head = kSceneHead;
  head.replace(head.find("target.yaml"), 11, "points.yaml");
  EXPECT_THROW(readScene(folder.write("scene.yaml", head)), FileError);
  EXPECT_EQ(readScene(folder.write("scene.yaml", head + "corners: {sigma: 0.1}\n")).target.type, TargetType::kPoints);
}

}  // namespace
}  // namespace poecal
