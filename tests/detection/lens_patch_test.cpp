// The lens over a part of a picture against OpenCV's, and tags whose edges it bends.
#include "detection/lens_patch.hpp"

#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "detection/tag_detector.hpp"
#include "detection/tag_refiner.hpp"
#include "support/cameras.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/rendering.hpp"

namespace poecal {
namespace {

Camera barrelCamera() { return test::plumbBob(640, 480, {400.0, 400.0}, {319.5, 239.5}, {-0.3, 0.1, 1e-3, -1e-3}); }

/// Straight pixels as OpenCV finds them.
std::vector<cv::Point2d> straightened(const Camera& camera, const std::vector<cv::Point2d>& px) {
  const cv::Matx33d K(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  const cv::Mat distortion(5, 1, CV_64F, const_cast<double*>(camera.distortion.data()));
  std::vector<cv::Point2d> straight;
  cv::undistortPoints(px, straight, K, distortion, cv::noArray(), K, cv::TermCriteria(cv::TermCriteria::COUNT, 40, 0.0));
  return straight;
}

TEST(LensPatch, StraightensAsOpenCvDoesAndBendsBack) {
  constexpr double kRough = 0.2;         // [px]; what LensPatch::of() allows
  constexpr double kTolerance = 1.5e-3;  // [px]; a step of Newton's method from 0.05 px off
  const Camera camera = barrelCamera();
  const Eigen::Vector2d low(480.0, 60.0);
  const auto patch = LensPatch::of(camera, low, low.array() + 120.0);
  ASSERT_TRUE(patch);
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d px = low + Eigen::Vector2d(rng.uniform(0.0, 120.0), rng.uniform(0.0, 120.0));
    const cv::Point2d expected = straightened(camera, {{px.x(), px.y()}}).front();
    const LensPatch::Straight straight = patch->straighten(px);
    const Eigen::Vector2d exact = patch->straightenExactly(px).px;
    EXPECT_THAT(straight.px, test::IsNear(Eigen::Vector2d(expected.x, expected.y), kRough));
    EXPECT_THAT(patch->row(px.y()).straightPixel(px.x()), test::IsNear(straight.px, 1e-12));
    EXPECT_THAT(exact, test::IsNear(Eigen::Vector2d(expected.x, expected.y), kTolerance));
    EXPECT_THAT(patch->bend(exact), test::IsNear(px, kTolerance));
    for (int axis = 0; axis < 2; ++axis) {
      constexpr double kStep = 1e-3;  // a polynomial of fifth degree: truncation 1e-9
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      const Eigen::Vector2d numeric = (patch->straighten(px + step).px - patch->straighten(px - step).px) / (2.0 * kStep);
      EXPECT_THAT(straight.J_straight_px.col(axis), test::IsNear(numeric, 1e-7));
    }
  }
}

TEST(LensPatch, FollowsAMildLensFarBelowAnyNoise) {
  constexpr double kTolerance = 1e-5;  // [px]; the polynomial leaves less than 1e-6 where it was fitted
  Camera camera = barrelCamera();
  camera.distortion.head<4>() << -0.02, 0.01, 1e-4, -1e-4;
  const Eigen::Vector2d low(480.0, 60.0);
  const auto patch = LensPatch::of(camera, low, low.array() + 60.0);
  ASSERT_TRUE(patch);
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d px = low + Eigen::Vector2d(rng.uniform(0.0, 60.0), rng.uniform(0.0, 60.0));
    const cv::Point2d expected = straightened(camera, {{px.x(), px.y()}}).front();
    EXPECT_THAT(patch->straightenExactly(px).px, test::IsNear(Eigen::Vector2d(expected.x, expected.y), kTolerance));
  }
}

TEST(LensPatch, IsNotThereBehindTheCamera) {
  Camera camera = barrelCamera();
  camera.model = DistortionModel::kEquidistant;
  camera.distortion = Eigen::VectorXd::Zero(4);
  camera.fx = camera.fy = 150.0;  // the left edge is at 122 degrees
  EXPECT_FALSE(LensPatch::of(camera, {0.0, 200.0}, {50.0, 250.0}));
}

TEST(LensPatch, EdgesThatTheLensBendsAreFittedAsBent) {
  constexpr double kTolerance = 0.03;  // [px]; taken as straight, the edges lie 0.3 px off in their middles
  const Camera camera = barrelCamera();
  const test::Quad truth = test::tiltedSquare({560.0, 80.0}, 70.0, 0.3, 0.4);
  std::vector<cv::Point2d> corners;
  for (int k = 0; k < 4; ++k) corners.emplace_back(truth(0, k), truth(1, k));
  const std::vector<cv::Point2d> straight_corners = straightened(camera, corners);
  const test::TagTexture tag = test::tagTexture("tag36h11", 7);
  std::vector<cv::Point2f> from, to;
  for (int k = 0; k < 4; ++k) {
    from.emplace_back(straight_corners[static_cast<std::size_t>(k)]);
    to.emplace_back(static_cast<float>(tag.corners(0, k)), static_cast<float>(tag.corners(1, k)));
  }

  constexpr int kFine = 6;
  const cv::Rect box(490, 10, 140, 140);
  std::vector<cv::Point2d> fine_px;
  for (int row = 0; row < kFine * box.height; ++row) {
    for (int column = 0; column < kFine * box.width; ++column) {
      fine_px.emplace_back(box.x + (column + 0.5) / kFine - 0.5, box.y + (row + 0.5) / kFine - 0.5);
    }
  }
  std::vector<cv::Point2d> cells;
  cv::perspectiveTransform(straightened(camera, fine_px), cells, cv::getPerspectiveTransform(from, to));
  cv::Mat fine(kFine * box.height, kFine * box.width, CV_8UC1, cv::Scalar(255));
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const cv::Point cell(cvRound(cells[k].x), cvRound(cells[k].y));
    if (cv::Rect({}, tag.texture.size()).contains(cell)) fine.data[k] = tag.texture.at<std::uint8_t>(cell);
  }
  cv::Mat picture(camera.height, camera.width, CV_8UC1, cv::Scalar(255));
  cv::Mat part = picture(box);
  cv::resize(fine, part, box.size(), 0, 0, cv::INTER_AREA);
  Rng rng = test::rngOfThisTest();
  test::degrade(picture, rng, 0.7, 1.0);

  const std::vector<TagDetection> tags = TagDetector("tag36h11").detect(picture, 2.0, true);
  ASSERT_EQ(tags.size(), 1u);
  const std::optional<TagFit> refined = TagRefiner("tag36h11", true, camera).refine(picture, tags.front().id, tags.front().px);
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->px, test::IsNear(truth, kTolerance));
}

}  // namespace
}  // namespace poecal
