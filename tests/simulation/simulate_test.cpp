#include "poecal/simulation/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "cell/sight.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/robot/robot_file.hpp"
#include "simulation/scene_files.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::smallScene;
using test::TempFolder;
using testing::HasSubstr;

/// exp of a twist by Padé and squaring.
Eigen::Matrix4d exponential(const Vector6d& xi) {
  Eigen::Matrix4d X = Eigen::Matrix4d::Zero();
  X.topLeftCorner<3, 3>() = hat(xi.head<3>());
  X.topRightCorner<3, 1>() = xi.tail<3>();
  return X.exp();
}

/// The pinhole with plumb_bob, written out from its definition.
Eigen::Vector2d pixelOf(const Camera& camera, const Eigen::Vector4d& p_camera) {
  const double x = p_camera.x() / p_camera.z(), y = p_camera.y() / p_camera.z(), r2 = x * x + y * y;
  const double k1 = camera.distortion(0), k2 = camera.distortion(1), p1 = camera.distortion(2), p2 = camera.distortion(3),
               k3 = camera.distortion(4);
  const double radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  return {camera.fx * (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) + camera.cx,
          camera.fy * (y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y) + camera.cy};
}

/// Every file of a folder with its content.
std::map<std::string, std::string> contentOf(const std::filesystem::path& folder) {
  std::map<std::string, std::string> content;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) content[std::filesystem::relative(entry.path(), folder).string()] = readTextFile(entry.path());
  }
  return content;
}

TEST(DrawSamples, EveryPoseIsWellInView) {
  const TempFolder folder;
  const Scene scene = smallScene(folder, "errors: {seed: 1, position: 1.0e-3, rotation: 3.0e-3}\nsamples: {count: 50, seed: 3}\n");
  const SampleTable table = drawSamples(scene);
  ASSERT_EQ(table.samples.size(), 50u);
  Eigen::Vector3d least = Eigen::Vector3d::Constant(9.0), most = -least;
  for (const Sample& sample : table.samples) {
    const Eigen::Isometry3d T_camera_target = scene.registration.cameraTarget(forwardKinematics(scene.actual, sample.q));
    const FaceSight sight = sightOf(scene.camera, scene.target, T_camera_target).front();
    EXPECT_GE(sight.facing_cos, 0.5 - 1e-12);
    EXPECT_GE(sight.shortest_side_px, 40.0);
    for (const Corner& corner : sight.corners) {
      EXPECT_GE(corner.px.x(), 15.5);
      EXPECT_LE(corner.px.x(), 303.5);
      EXPECT_GE(corner.px.y(), 11.5);
      EXPECT_LE(corner.px.y(), 227.5);
    }
    least = least.cwiseMin(sample.q);
    most = most.cwiseMax(sample.q);
  }
  // Uniform draws reach most of each range; 50 of them leave more than a fifth out with a probability below 1e-3.
  EXPECT_GT(most(0) - least(0), 0.8 * 4.0);
  EXPECT_GT(most(1) - least(1), 0.8 * 1.8);
  EXPECT_GT(most(2) - least(2), 0.8 * 0.2);
  EXPECT_LE(most.cwiseAbs().cwiseMax(least.cwiseAbs())(2), 0.1);
}

TEST(DrawSamples, RowsKnowPoseTimeAndDirection) {
  const TempFolder folder;
  const SampleTable table = drawSamples(smallScene(folder, "samples: {count: 4, seed: 3, repeats: 2}\n"));
  ASSERT_EQ(table.samples.size(), 8u);
  for (std::size_t row = 0; row < 8; ++row) {
    const Sample& sample = table.samples[row];
    EXPECT_EQ(sample.pose, static_cast<long>(row / 2));
    EXPECT_EQ(sample.stamp, 10.0 * static_cast<double>(row));
    if (row < 2) {
      EXPECT_THAT(sample.dir, test::IsNear(Eigen::Vector3d(1, 1, 1), 0.0));
      continue;
    }
    const Eigen::VectorXd& before = table.samples[row / 2 * 2 - 2].q;
    for (int k = 0; k < 3; ++k) EXPECT_EQ(sample.dir(k), sample.q(k) > before(k) ? 1.0 : -1.0);
    EXPECT_THAT(sample.q, test::IsNear(table.samples[row / 2 * 2].q, 0.0));
  }
  EXPECT_EQ(table.samples[7].image, "images/0007.png");
}

TEST(DrawSamples, UnlimitedJointsTurnHalfATurnEitherWay) {
  const TempFolder folder;
  Scene scene = smallScene(folder, "samples: {count: 40, seed: 3}\n");
  for (const auto& limits : {std::optional<JointLimits>(), std::optional<JointLimits>(JointLimits{-8.0, 10.0})}) {
    scene.nominal.joints[0].limits = limits;
    const double middle = limits ? 1.0 : 0.0;
    double furthest = 0.0;
    for (const Sample& sample : drawSamples(scene).samples) furthest = std::max(furthest, std::abs(sample.q(0) - middle));
    EXPECT_LE(furthest, M_PI);
    EXPECT_GT(furthest, 0.8 * M_PI);
  }
  scene.nominal.joints[2].limits.reset();
  EXPECT_THROW(drawSamples(scene), FileError) << "a sliding joint has no natural range";
}

TEST(DrawSamples, TargetOutOfSightIsInsufficientData) {
  const TempFolder folder;
  Scene scene = smallScene(folder, "samples: {count: 3, seed: 3}\n");
  scene.registration.T_camera_near.translation().z() = -2.0;
  EXPECT_THROW(
      try { drawSamples(scene); } catch (const InsufficientData& error) {
        EXPECT_THAT(error.what(), HasSubstr("pose 1 of 3"));
        throw;
      },
      InsufficientData);
}

TEST(DrawSamples, EachPoseIsToldAndTheLastMayStopIt) {
  const TempFolder folder;
  const Scene scene = smallScene(folder, "samples: {count: 3, seed: 3, repeats: 2}\n");
  std::vector<std::size_t> left;
  const SampleTable table =
      drawSamples(scene, {.progress = [&left](const std::string&, std::size_t done, std::size_t total) { left.push_back(total - done); }});
  EXPECT_EQ(left, (std::vector<std::size_t>{2, 1, 0}));
  EXPECT_EQ(samplesCsv(table), samplesCsv(drawSamples(scene)));
  const auto last = [](const std::string&, std::size_t done, std::size_t) {
    if (done == 3) throw std::runtime_error("enough");
  };
  EXPECT_THAT([&] { drawSamples(scene, {.progress = last}); }, testing::ThrowsMessage<std::runtime_error>("enough"));
}

TEST(TrueCorners, MatchMatrixExponentialsAndTheLensByHand) {
  const TempFolder folder;
  const Scene scene = smallScene(folder, "errors: {seed: 1, position: 1.0e-3, rotation: 3.0e-3}\nsamples: {count: 10, seed: 3}\n");
  const SampleTable table = drawSamples(scene);
  const std::vector<ImageCorners> images = trueCorners(scene, table);
  ASSERT_EQ(images.size(), 10u);
  for (std::size_t k = 0; k < images.size(); ++k) {
    Eigen::Matrix4d T = scene.registration.T_camera_near.matrix();
    for (std::size_t joint = 0; joint < 3; ++joint) {
      T = T * exponential(scene.actual.joints[joint].xi * table.samples[k].q(static_cast<Eigen::Index>(joint)));
    }
    T = T * exponential(scene.actual.gamma) * scene.registration.T_far_target.matrix();
    ASSERT_EQ(images[k].corners.size(), 4u);
    const Eigen::Vector2d unit[] = {{-0.05, 0.05}, {0.05, 0.05}, {0.05, -0.05}, {-0.05, -0.05}};
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector4d p_camera = T * Eigen::Vector4d(unit[corner].x(), unit[corner].y(), 0.0, 1.0);
      // Matrices agree to 1e-14, pixels are some hundreds of that.
      EXPECT_THAT(images[k].corners[static_cast<std::size_t>(corner)].px, test::IsNear(pixelOf(scene.camera, p_camera), 1e-10));
    }
  }
}

TEST(TrueCorners, TagsThatTurnAwayOrLeaveThePictureAreLeftOut) {
  // Two sides of a cube: one before the camera, one that looks sideways.
  const TempFolder folder;
  Scene scene = smallScene(folder, "");
  TargetTag sideways{.id = 8, .size = 0.1, .T_target_tag = Eigen::Isometry3d(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()))};
  scene.target = apriltagTarget("tag36h11", {{.id = 7, .size = 0.1}, sideways});
  SampleTable table;
  for (const double slide : {0.0, 0.1}) {
    Sample sample;
    sample.q = Eigen::Vector3d(0.0, 0.0, slide);
    table.samples.push_back(sample);
  }
  const std::vector<ImageCorners> images = trueCorners(scene, table);
  ASSERT_EQ(images[0].corners.size(), 4u);
  for (const Corner& corner : images[0].corners) EXPECT_EQ(corner.id.tag, 7);
  scene.registration.T_camera_near.translation().y() = 0.1;
  EXPECT_TRUE(trueCorners(scene, table)[1].corners.empty());
}

TEST(Simulate, CaptureIsReadAsTheSceneStatesItAndTheTruthIsBeside) {
  const TempFolder folder;
  const Scene scene = smallScene(folder,
                                 "stated: stated.yaml\nstated_target: larger.yaml\nerrors: {seed: 1, position: 1.0e-3, rotation: 3.0e-3}\n"
                                 "samples: {count: 6, seed: 3, repeats: 2}\ncorners: {sigma: 0.1}\n");
  // A slash at the end must not put the truth inside.
  const SimulateSummary summary = simulate(scene, folder.path() / "out" / "", {});
  EXPECT_EQ(summary.poses, 6u);
  EXPECT_EQ(summary.samples, 12u);
  EXPECT_EQ(summary.corners, 48u);
  EXPECT_FALSE(summary.pictures);
  EXPECT_EQ(summary.truth, folder.path() / "out-truth");

  const Capture capture = readCapture(folder.path() / "out");
  EXPECT_EQ(capture.name, "small");
  EXPECT_EQ(capture.setup, poecal::Setup::kEyeToHand);
  EXPECT_EQ(capture.camera->fx, 404.0);
  EXPECT_EQ(capture.target.tags.front().size, 0.101);
  EXPECT_THAT(capture.arm->joints[0].xi, test::IsNear(scene.nominal.joints[0].xi, 0.0));
  EXPECT_EQ(readTextFile(capture.robot_file), readTextFile(scene.robot_file)) << "copied with its comments";
  EXPECT_EQ(poseGroups(capture.table.samples).size(), 6u);
  EXPECT_EQ(readDetections(capture.detections_file, capture.target).images.size(), 12u);

  EXPECT_EQ(readCamera(summary.truth / "camera.yaml").fx, 400.0);
  EXPECT_EQ(readTarget(summary.truth / "target.yaml").tags.front().size, 0.1);
  const Arm actual = readRobotYaml(summary.truth / "actual.yaml");
  for (std::size_t k = 0; k < 3; ++k) EXPECT_THAT(actual.joints[k].xi, test::IsNear(scene.actual.joints[k].xi, 1e-15));
  EXPECT_THAT(readTextFile(summary.truth / "truth.yaml"), HasSubstr("corners: {sigma: 0.1}"));
  const Detections exact = readDetections(summary.truth / "corners.csv", scene.target);
  const std::vector<ImageCorners> expected = trueCorners(scene, drawSamples(scene));
  ASSERT_EQ(exact.images.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_THAT(exact.images[k].corners[2].px, test::IsNear(expected[k].corners[2].px, 0.0));
  }
}

TEST(Simulate, CornerNoiseIsNormalWithItsSigma) {
  const TempFolder folder;
  const Scene scene = smallScene(folder, "samples: {count: 100, seed: 5}\ncorners: {sigma: 0.1}\n");
  const SimulateSummary summary = simulate(scene, folder.path() / "out", {});
  const Detections noisy = readDetections(folder.path() / "out" / "detections.csv", scene.target);
  const Detections exact = readDetections(summary.truth / "corners.csv", scene.target);
  std::vector<double> noise;
  for (std::size_t k = 0; k < exact.images.size(); ++k) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Eigen::Vector2d difference = noisy.images[k].corners[corner].px - exact.images[k].corners[corner].px;
      noise.insert(noise.end(), {difference.x(), difference.y()});
    }
  }
  const double count = static_cast<double>(noise.size());
  ASSERT_EQ(noise.size(), 800u);
  double chi_square = 0.0;
  for (const double value : noise) chi_square += value * value / (0.1 * 0.1);
  EXPECT_GT(chi_square, chiSquareQuantile(0.001, count));
  EXPECT_LT(chi_square, chiSquareQuantile(0.999, count));
  EXPECT_NEAR(mean(noise), 0.0, 3.3 * 0.1 / std::sqrt(count));
  // 4.6 % of a normal sample lie beyond two sigma.
  const auto beyond = std::count_if(noise.begin(), noise.end(), [](double value) { return std::abs(value) > 0.2; });
  const auto [lower, upper] = wilsonInterval(static_cast<int>(beyond), static_cast<int>(count));
  EXPECT_LT(lower, 0.046);
  EXPECT_GT(upper, 0.046);
}

TEST(Simulate, PicturesDoNotDependOnTheNumberOfJobs) {
  const TempFolder folder;
  const Scene scene = smallScene(folder, "samples: {count: 3, seed: 3}\nintrinsics: {target: board.yaml, count: 2}\n");
  simulate(scene, folder.path() / "one", {.jobs = 1});
  const SimulateSummary summary = simulate(scene, folder.path() / "four", {.jobs = 4});
  EXPECT_TRUE(summary.pictures);
  EXPECT_EQ(summary.boards, 2u);
  const auto one = contentOf(folder.path() / "one");
  EXPECT_EQ(one, contentOf(folder.path() / "four"));
  EXPECT_EQ(contentOf(folder.path() / "one-truth"), contentOf(folder.path() / "four-truth"));
  std::vector<std::string> names;
  for (const auto& [name, content] : one) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre("capture.yaml", "images/0000.png", "images/0001.png", "images/0002.png", "intrinsics/0000.png",
                                          "intrinsics/0001.png", "intrinsics/target.yaml", "robot.yaml", "samples.csv", "target.yaml"));
  EXPECT_NE(one.at("images/0000.png"), one.at("images/0001.png"));
  EXPECT_EQ(readCapture(folder.path() / "one").intrinsics_folder, folder.path() / "one" / "intrinsics");
}

TEST(Simulate, FolderThatIsNotEmptyStaysAsItIs) {
  const TempFolder folder;
  const Scene scene = smallScene(folder, "samples: {count: 3, seed: 3}\ncorners: {sigma: 0.1}\n");
  folder.write("out/notes.txt", "mine");
  EXPECT_THROW(simulate(scene, folder.path() / "out", {}), FileError);
  EXPECT_EQ(contentOf(folder.path() / "out").size(), 1u);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out-truth"));
  folder.write("new-truth/truth.yaml", "of another");
  EXPECT_THROW(simulate(scene, folder.path() / "new", {}), FileError);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "new"));
}

TEST(Simulate, SamplesFromAFileAreTakenAsTheyAre) {
  const TempFolder folder;
  folder.write("samples.csv", "image,q1,q2,q3,temperature\na.png,0.1,0.2,0.01,21.5\nb.png,-0.1,0.1,0.02,22\nc.png,0.3,-0.2,0.03,22.5\n");
  const Scene scene = smallScene(folder, "samples: {file: samples.csv}\ncorners: {sigma: 0}\n");
  const SimulateSummary summary = simulate(scene, folder.path() / "out", {});
  EXPECT_EQ(summary.samples, 3u);
  const Capture capture = readCapture(folder.path() / "out");
  EXPECT_EQ(capture.table.samples[1].image, "b.png");
  EXPECT_EQ(capture.table.samples[1].temperature, 22.0);
  EXPECT_FALSE(capture.table.samples[1].stamp.has_value());
}

class CalibrationData : public testing::TestWithParam<const char*> {
 protected:
  static Scene scene(const char* file) { return readScene(std::filesystem::path(POECAL_SOURCE_DIR) / "calib_data" / GetParam() / file); }
};

TEST_P(CalibrationData, PicturesShowTheWholeTagAndEveryJointMoves) {
  Scene scene = this->scene("scene.yaml");
  EXPECT_TRUE(scene.image && scene.board);
  EXPECT_EQ(scene.count, 60);
  scene.count = 20;
  const SampleTable table = drawSamples(scene);
  for (const ImageCorners& image : trueCorners(scene, table)) ASSERT_EQ(image.corners.size(), 4u);
  for (Eigen::Index joint = 0; joint < scene.nominal.jointCount(); ++joint) {
    double least = INFINITY, most = -INFINITY;
    for (const Sample& sample : table.samples) {
      least = std::min(least, sample.q(joint));
      most = std::max(most, sample.q(joint));
    }
    const JointLimits limits = scene.nominal.joints[static_cast<std::size_t>(joint)].limits.value_or(JointLimits{-M_PI, M_PI});
    EXPECT_GT(most - least, 0.5 * (limits.upper - limits.lower)) << "joint " << joint + 1;
  }
}

TEST_P(CalibrationData, CornersWithoutPicturesMakeACapture) {
  const TempFolder folder;
  Scene scene = this->scene("scene-corners.yaml");
  scene.count = 3;
  simulate(scene, folder.path() / "out", {});
  const Capture capture = readCapture(folder.path() / "out");
  EXPECT_EQ(capture.arm->name, scene.nominal.name);
  EXPECT_EQ(capture.arm->jointCount(), scene.nominal.jointCount());
  EXPECT_TRUE(capture.camera.has_value());
  EXPECT_EQ(readDetections(capture.detections_file, capture.target).images.size(), 3u);
}

INSTANTIATE_TEST_SUITE_P(Arms, CalibrationData, testing::Values("puma560", "cobot6", "arm7", "scara"));

}  // namespace
}  // namespace poecal
