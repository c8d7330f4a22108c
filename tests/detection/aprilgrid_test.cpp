#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "poecal/core/statistics.hpp"
#include "poecal/detection/detector.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/simulation/renderer.hpp"
#include "support/cameras.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

// Kalibr's sheet has black squares that touch every corner of its tags; libapriltag alone finds half of the tags, some off by pixels.
TEST(AprilGrid, CornersOfKalibrsSheetAreFoundAsSaddles) {
  const Camera camera = test::plumbBob(1280, 960, {1400.0, 1400.0}, {640.0, 480.0}, {-0.08});
  const Target grid = aprilgridTarget("tag36h11", 6, 4, 0.05, 0.3, 0);
  Rng rng = test::rngOfThisTest();
  std::vector<double> errors;
  std::size_t found = 0, there = 0;
  const test::TempFolder folder;
  std::vector<std::string> names;
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 2; ++k) {
    Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
    T_camera_target.linear() =
        expSo3({M_PI + rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), 0.0}) * expSo3({0.0, 0.0, rng.uniform(-0.5, 0.5)});
    T_camera_target.translation() = Eigen::Vector3d(0.0, 0.0, 0.75) - T_camera_target.linear() * Eigen::Vector3d(0.19, 0.12, 0.0);
    poses.push_back(T_camera_target);
    names.push_back("picture" + std::to_string(k) + ".png");
    cv::imwrite((folder.path() / names.back()).string(), renderTarget(camera, grid, T_camera_target, {}, 5, static_cast<std::uint64_t>(k)));
  }
  DetectOptions options;
  options.camera = camera;
  const DetectResult result = detect(folder.path(), names, grid, options);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    there += grid.points.size();
    for (const Corner& corner : result.detections.images[k].corners) {
      const auto px = project(camera, poses[k] * grid.find(corner.id)->p_target);
      ASSERT_TRUE(px);
      errors.push_back((corner.px - *px).norm());
      ++found;
    }
  }
  EXPECT_GT(static_cast<double>(found), 0.9 * static_cast<double>(there));
  // A saddle in a window of some 7 px at a noise of 2 grey levels is good to 0.035 px, a whole tag fitted from there on to 0.01.
  EXPECT_LT(rms(errors), 0.02);
  EXPECT_LT(quantile(errors, 1.0), 0.1);
}

/// Rms and largest distance of what is found in one rendered picture of `drawn`, when `searched` is looked for, and how many corners.
struct Found {
  std::size_t corners = 0;
  double rms_px = 0.0, largest_px = 0.0;
};

Found findIn(const Target& drawn, const Target& searched, bool with_lens) {
  const Camera camera = test::plumbBob(1280, 960, {1400.0, 1400.0}, {640.0, 480.0}, {-0.08});
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  T_camera_target.linear() = expSo3({M_PI + 0.3, -0.2, 0.0}) * expSo3({0.0, 0.0, 0.4});
  T_camera_target.translation() = Eigen::Vector3d(0.0, 0.0, 0.75) - T_camera_target.linear() * Eigen::Vector3d(0.19, 0.12, 0.0);
  const test::TempFolder folder;
  cv::imwrite((folder.path() / "picture.png").string(), renderTarget(camera, drawn, T_camera_target, {}, 5, 1));
  DetectOptions options;
  if (with_lens) options.camera = camera;
  const DetectResult result = detect(folder.path(), {"picture.png"}, searched, options);
  std::vector<double> errors;
  for (const Corner& corner : result.detections.images[0].corners) {
    errors.push_back((corner.px - *project(camera, T_camera_target * drawn.find(corner.id)->p_target)).norm());
  }
  return errors.empty() ? Found{} : Found{errors.size(), rms(errors), quantile(errors, 1.0)};
}

// Kalibr's tags have a black border of two cells, which libapriltag does not read.
TEST(AprilGrid, BordersOfOneAndTwoCellsAreReadAsThePictureHasThem) {
  const auto grid = [](int border_bits) { return aprilgridTarget("tag36h11", 6, 4, 0.05, 0.3, 7, border_bits); };
  for (const int drawn : {1, 2}) {
    for (const int stated : {0, drawn}) {
      const Found found = findIn(grid(drawn), grid(stated), true);
      EXPECT_GT(found.corners, 86U) << drawn << " " << stated;  // nine of ten
      EXPECT_LT(found.rms_px, 0.02) << drawn << " " << stated;
      EXPECT_LT(found.largest_px, 0.1) << drawn << " " << stated;
    }
  }
  EXPECT_EQ(findIn(grid(2), grid(1), true).corners, 0U) << "as stated";
  // Without the lens edges are taken as straight, and the picture is as good as saddles are.
  EXPECT_LT(findIn(grid(2), grid(0), false).rms_px, 0.1);
}

// A lone tag has no neighbours that would contradict corners that the squares have drawn away.
TEST(AprilGrid, ALoneTagWhoseCornersAreOffIsLeftOut) {
  constexpr double kTolerance = 0.1;  // [px]; a large tag fitted through its lens is good to 0.01, corners drawn away are off by pixels
  Camera camera;
  camera.width = 170;
  camera.height = 170;
  camera.fx = camera.fy = 700.0;
  camera.cx = camera.cy = 84.5;
  camera.distortion = Eigen::VectorXd::Zero(5);
  const Target grid = aprilgridTarget("tag36h11", 6, 4, 0.05, 0.3, 0);
  Rng rng = test::rngOfThisTest();
  const test::TempFolder folder;
  DetectOptions options;
  options.camera = camera;
  int found = 0, left_out = 0;
  for (int k = 0; k < 30; ++k) {
    Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
    T_camera_target.linear() =
        expSo3({M_PI + rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), 0.0}) * expSo3({0.0, 0.0, rng.uniform(-3.0, 3.0)});
    const Eigen::Vector3d middle = grid.tags[8].T_target_tag.translation();
    T_camera_target.translation() = Eigen::Vector3d(0.0, 0.0, 0.4) - T_camera_target.linear() * middle;
    cv::imwrite((folder.path() / "lone.png").string(), renderTarget(camera, grid, T_camera_target, {}, 5, static_cast<std::uint64_t>(k)));
    const DetectResult result = detect(folder.path(), {"lone.png"}, grid, options);
    for (const PictureNote& note : result.notes) left_out += note.message == "tag 8 stands alone and does not fit the picture";
    for (const Corner& corner : result.detections.images.front().corners) {
      EXPECT_THAT(corner.px, test::IsNear(*project(camera, T_camera_target * grid.find(corner.id)->p_target), kTolerance)) << k;
      ++found;
    }
  }
  EXPECT_GE(found, 4 * 5);
  EXPECT_GE(left_out, 1);
}

}  // namespace
}  // namespace poecal
