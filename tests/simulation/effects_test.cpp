// Scenes with effects: the same in corners and pictures, unknown to the capture, told by the truth.
#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "poecal/core/error.hpp"
#include "poecal/simulation/renderer.hpp"
#include "poecal/simulation/simulate.hpp"
#include "simulation/scene_files.hpp"
#include "simulation/streams.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::smallScene;
using test::TempFolder;
using testing::HasSubstr;

const std::string kSamples = "samples: {count: 4, seed: 3}\n";
const std::string kCorners = "corners: {sigma: 0}\n";

TEST(SceneWithEffects, CornersAreThoseOfTheArmThatMovedFurther) {
  // Second formula: joints 1 and 3 turned by hand, no effect.
  const TempFolder folder;
  const Scene scene = smallScene(folder, kSamples + kCorners +
                                             "effects:\n- {effect: joint_gain, location: joint:1, parameters: {gain: 0.01}}\n"
                                             "- {effect: joint_backlash, location: joint:3, parameters: {half_gap: 5.0e-4}}\n");
  Scene plain = scene;
  plain.effects.clear();
  const SampleTable table = drawSamples(scene);
  SampleTable moved = table;
  for (Sample& sample : moved.samples) {
    sample.q(0) *= 1.01;
    sample.q(2) += 5e-4 * sample.dir(2);
  }
  const auto actual = trueCorners(scene, table), expected = trueCorners(plain, moved);
  for (std::size_t k = 0; k < table.samples.size(); ++k) {
    ASSERT_EQ(actual[k].corners.size(), 4u);
    for (std::size_t j = 0; j < 4; ++j) EXPECT_THAT(actual[k].corners[j].px, test::IsNear(expected[k].corners[j].px, 1e-9));
  }
}

TEST(SceneWithEffects, CaptureHasTheReadingsAndTheTruthTheJoints) {
  const TempFolder folder;
  const Scene scene = smallScene(
      folder, kSamples + kCorners + "effects: [{effect: joint_slip, location: joint:2, parameters: {time: 15, offset: 0.01}}]\n");
  simulate(scene, folder.path() / "out", {});
  const SampleTable readings = readSamples(folder.path() / "out" / "samples.csv", 3, nullptr);
  const SampleTable joints = readSamples(folder.path() / "out-truth" / "samples.csv", 3, nullptr);
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d slip = k < 2 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(0.0, 0.01, 0.0);
    EXPECT_THAT(joints.samples[k].q - readings.samples[k].q, test::IsNear(slip, 1e-15));
  }
  EXPECT_THAT(
      readTextFile(folder.path() / "out-truth" / "truth.yaml"),
      HasSubstr(
          "effects:\n- {effect: joint_slip, location: joint:2, driver: stamp, parameters: {time: 15.0, offset: 0.01}, units: {time: s, "
          "offset: rad}}\n"));
  EXPECT_THAT(readTextFile(folder.path() / "out" / "capture.yaml"), testing::Not(HasSubstr("slip")));
}

TEST(SceneWithEffects, DriversAreDrawnWhereTheyAreNeeded) {
  const TempFolder folder;
  const SampleTable still = drawSamples(smallScene(folder, kSamples + kCorners));
  const SampleTable moving = drawSamples(
      smallScene(folder, kSamples + kCorners + "effects: [{effect: time_offset, location: timing, parameters: {offset: 0.01}}]\n"));
  const SampleTable warm = drawSamples(smallScene(
      folder, kSamples + kCorners +
                  "effects: [{effect: link_expansion, location: link:1, driver: temperature, parameters: {expansion: 1.0e-4}}]\n"));
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(still.samples[k].dq.size(), 0);
    EXPECT_FALSE(still.samples[k].temperature.has_value());
    EXPECT_EQ(moving.samples[k].dq.size(), 3);
    EXPECT_TRUE(warm.samples[k].temperature.has_value());
    EXPECT_EQ(moving.samples[k].q, still.samples[k].q) << "effects do not choose the poses";
  }
  EXPECT_GT(*warm.samples[3].temperature, *warm.samples[0].temperature + 5.0);
}

TEST(SceneWithEffects, PicturesShowThem) {
  // Second formula: the picture drawn at the pose that the moved camera sees and through the changed lens.
  const TempFolder folder;
  const Scene scene = smallScene(folder,
                                 "samples: {count: 2, seed: 3}\n"
                                 "effects:\n- {effect: camera_slip, location: camera.mount, parameters: {time: 5, ty: 4.0e-3}}\n"
                                 "- {effect: principal_point, location: camera.lens, parameters: {dx: 2.5}}\n");
  simulate(scene, folder.path() / "out", {.jobs = 1});
  const Sample sample = drawSamples(scene).samples[1];
  Camera camera = scene.camera;
  camera.cx += 2.5;
  const Eigen::Isometry3d T_camera_target =
      Eigen::Translation3d(0, 4e-3, 0) * scene.registration.cameraTarget(forwardKinematics(scene.actual, sample.q));
  const cv::Mat expected = renderTarget(camera, scene.target, T_camera_target, *scene.image, scene.seed, streamOf(Purpose::kPicture, 1));
  const cv::Mat actual = cv::imread((folder.path() / "out" / sample.image).string(), cv::IMREAD_GRAYSCALE);
  // Rounding of the pose may turn single grey levels.
  EXPECT_LE(cv::norm(actual, expected, cv::NORM_INF), 1.0);
}

TEST(SceneWithEffects, SamplesThatLackADriverAreRefused) {
  const TempFolder folder;
  folder.write("samples.csv", "image,q1,q2,q3\na.png,0.1,0.2,0.01\nb.png,-0.1,0.1,0.02\n");
  const Scene scene = smallScene(folder, "samples: {file: samples.csv}\n" + kCorners +
                                             "effects: [{effect: joint_backlash, location: joint:1, parameters: {half_gap: 1.0e-3}}]\n");
  EXPECT_THROW(
      try { simulate(scene, folder.path() / "out", {}); } catch (const InsufficientData& error) {
        EXPECT_THAT(error.what(), HasSubstr("joint_backlash at joint:1 cannot be computed: no dir1.. columns"));
        throw;
      },
      InsufficientData);
}

}  // namespace
}  // namespace poecal
