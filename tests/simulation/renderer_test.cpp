#include "poecal/simulation/renderer.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "detection/tag_detector.hpp"
#include "detection/tag_refiner.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "support/cameras.hpp"
#include "support/exact_tag.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

const ImageOptions kClean{.blur = 0.0, .noise = 0.0, .background = "plain"};

/// A small picture, so that each case stays fast; distorted enough to bend edges by a few pixels.
Camera smallCamera() { return test::plumbBob(240, 180, {260.0, 258.0}, {121.3, 88.6}, {-0.08, 0.05, 0.0008, -0.0005}); }

Eigen::Isometry3d pose(const Eigen::Vector3d& rotation_vector, const Eigen::Vector3d& position) {
  Eigen::Isometry3d T(Eigen::Translation3d{position});
  T.linear() = expSo3(rotation_vector);
  return T;
}

/// Where the line between two points of the target crosses a row (axis 1) or a column (axis 0) of pixels: the other pixel coordinate.
double crossing(const Camera& camera, const Eigen::Vector3d& a_camera, const Eigen::Vector3d& b_camera, int axis, double level) {
  double lower = 0.0, upper = 1.0;
  const auto px = [&](double t) { return *project(camera, (1.0 - t) * a_camera + t * b_camera); };
  const bool rising = px(1.0)(axis) > px(0.0)(axis);
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (lower + upper);
    ((px(middle)(axis) < level) == rising ? lower : upper) = middle;
  }
  return px(lower)(1 - axis);
}

struct EdgeErrors {
  std::vector<double> errors;  ///< measured - true place of an edge on each row (or column) that it crosses [px]
};

/// Along a row (axis 1) or a column (axis 0) the place of an edge from grey a to grey b follows from the sum of the greys between.
EdgeErrors measureEdge(const cv::Mat& picture, const Camera& camera, const Eigen::Vector3d& a_camera, const Eigen::Vector3d& b_camera,
                       int axis) {
  constexpr int kReach = 6;  // pixels either way: beyond the blur, within the border and the margin of the tag
  EdgeErrors edge;
  const double first = (*project(camera, a_camera))(axis), last = (*project(camera, b_camera))(axis);
  for (int level = static_cast<int>(std::ceil(std::min(first, last))); level < std::max(first, last); ++level) {
    const double truth = crossing(camera, a_camera, b_camera, axis, level);
    const int middle = static_cast<int>(std::lround(truth));
    const auto grey = [&](int place) -> double {
      return axis == 1 ? picture.at<std::uint8_t>(level, place) : picture.at<std::uint8_t>(place, level);
    };
    const double before = grey(middle - kReach), after = grey(middle + kReach);
    double measured = middle - kReach - 0.5;
    for (int place = middle - kReach; place <= middle + kReach; ++place) measured += (grey(place) - after) / (before - after);
    edge.errors.push_back(measured - truth);
  }
  return edge;
}

class RenderedEdges : public testing::TestWithParam<double> {};

TEST_P(RenderedEdges, LieWhereTheProjectionOfTheCornersSays) {
  // All four sides of a big tag, tilted about both axes and rolled a little or not at all (edges along the pixels are the hard case of
  // sampling).
  const Camera camera = smallCamera();
  const Eigen::Isometry3d T_camera_target =
      pose({0.25, 0.0, 0.0}, {0.003, -0.004, 0.23}) * pose({0.0, -0.2, 0.0}, {0, 0, 0}) * pose({0, 0, GetParam()}, {0, 0, 0});
  const cv::Mat picture = renderTarget(camera, apriltagTarget("tag36h11", {{.id = 4, .size = 0.1}}), T_camera_target,
                                       {.blur = 0.7, .noise = 0.0, .background = "plain"}, 1, 1);
  const Eigen::Matrix<double, 3, 4> corners = tagCorners(0.1);
  for (int side = 0; side < 4; ++side) {
    // The middle 80 % of the side: a corner is not an edge.
    const Eigen::Vector3d a = T_camera_target * Eigen::Vector3d(0.9 * corners.col(side) + 0.1 * corners.col((side + 1) % 4));
    const Eigen::Vector3d b = T_camera_target * Eigen::Vector3d(0.1 * corners.col(side) + 0.9 * corners.col((side + 1) % 4));
    const int axis = side % 2;  // sides 0-1 and 2-3 run along rows, so they cross columns
    const EdgeErrors edge = measureEdge(picture, camera, a, b, axis);
    ASSERT_GT(edge.errors.size(), 50u);
    // Rounding to whole greys leaves 0.29 sqrt(5) / 205 = 0.003 px on each crossing and a fourth of that in the mean of fifty.
    EXPECT_NEAR(mean(edge.errors), 0.0, 0.0015) << "side " << side;
    EXPECT_LT(rms(edge.errors), 0.006) << "side " << side;
  }
}

INSTANTIATE_TEST_SUITE_P(Rolls, RenderedEdges, testing::Values(0.0, 0.02, 0.3, -0.4));

TEST(Renderer, PixelCentresAreWholeNumbers) {
  // A chessboard seen straight on without a lens' distortion, its corner 0 on the pixel (100, 60): in the picture that pixel is half black
  // and half white, its neighbours across are black and white.
  Camera camera = smallCamera();
  camera.distortion.setZero();
  camera.fx = camera.fy = 200.0;
  camera.cx = 100.0;
  camera.cy = 60.0;
  const cv::Mat picture = renderTarget(camera, chessboardTarget(3, 3, 0.05), pose({0, 0, 0}, {0, 0, 1}), kClean, 1, 1);
  const int ink = picture.at<std::uint8_t>(55, 95), paper = picture.at<std::uint8_t>(55, 105);
  EXPECT_LT(ink, paper);
  EXPECT_EQ(picture.at<std::uint8_t>(65, 105), ink);
  // Half a pixel of each, rounded.
  EXPECT_NEAR(picture.at<std::uint8_t>(60, 100), (ink + paper) / 2.0, 0.5 + 1e-3);
  EXPECT_NEAR(picture.at<std::uint8_t>(60, 95), (ink + paper) / 2.0, 0.5 + 1e-3);
  EXPECT_EQ(picture.at<std::uint8_t>(59, 99), ink);
  EXPECT_EQ(picture.at<std::uint8_t>(59, 101), paper);
}

TEST(Renderer, AprilTagReadsItsOwnCorners) {
  const Camera camera = smallCamera();
  const Eigen::Isometry3d T_camera_target = pose({0.3, -0.2, 0.7}, {0.01, 0.0, 0.3});
  for (const char* family : {"tag36h11", "tag25h9", "tagStandard41h12"}) {
    const cv::Mat picture =
        renderTarget(camera, apriltagTarget(family, {{.id = 9, .size = 0.08}}), T_camera_target, {.blur = 0.7, .noise = 1.0}, 1, 1);
    const std::vector<TagDetection> tags = TagDetector(family).detect(picture, 1.0, true);
    ASSERT_EQ(tags.size(), 1u) << family;
    EXPECT_EQ(tags.front().id, 9);
    const Eigen::Matrix<double, 3, 4> corners = tagCorners(0.08);
    for (int corner = 0; corner < 4; ++corner) {
      // The library's own error is below 0.1 px, tags of other families than 36h11 have thinner edges; a wrong order would be off by a
      // side.
      EXPECT_THAT(Eigen::Vector2d(tags.front().px.col(corner)), test::IsNear(*project(camera, T_camera_target * corners.col(corner)), 0.5))
          << family << " corner " << corner;
    }
  }
}

TEST(Renderer, BacksAndThingsBehindTheCameraAreNotDrawn) {
  const Camera camera = smallCamera();
  const Target tag = apriltagTarget("tag36h11", {{.id = 4, .size = 0.1}});
  for (const Eigen::Isometry3d& T_camera_target :
       {pose({M_PI, 0, 0}, {0, 0, 0.4}), pose({0, 0, 0}, {0, 0, -0.4}), pose({0, 0, 0}, {5.0, 0, 0.4})}) {
    const cv::Mat picture = renderTarget(camera, tag, T_camera_target, kClean, 1, 1);
    double least = 0.0, most = 0.0;
    cv::minMaxLoc(picture, &least, &most);
    EXPECT_EQ(least, most);
  }
}

TEST(Renderer, NearerTagHidesTheOneBehind) {
  // Both face the camera along one line of sight; the middle of the picture is the near one's whichever stands first in the target.
  const Camera camera = smallCamera();
  const TargetTag near_tag{.id = 4, .size = 0.05, .T_target_tag = Eigen::Isometry3d::Identity()};
  const TargetTag far_tag{.id = 5, .size = 0.1, .T_target_tag = pose({0, 0, 0}, {0, 0, 0.1})};
  const Eigen::Isometry3d T_camera_target = pose({0, 0, 0.1}, {0, 0, 0.2});
  const cv::Mat near_alone = renderTarget(camera, apriltagTarget("tag36h11", {near_tag}), T_camera_target, kClean, 1, 1);
  const cv::Rect middle(100, 70, 40, 40);
  for (const std::vector<TargetTag>& tags : {std::vector<TargetTag>{near_tag, far_tag}, std::vector<TargetTag>{far_tag, near_tag}}) {
    const cv::Mat both = renderTarget(camera, apriltagTarget("tag36h11", tags), T_camera_target, kClean, 1, 1);
    EXPECT_EQ(cv::norm(both(middle), near_alone(middle), cv::NORM_INF), 0.0);
    EXPECT_GT(cv::norm(both, near_alone, cv::NORM_INF), 0.0) << "the far tag looks out from behind";
  }
}

TEST(Renderer, NoiseHasItsStandardDeviation) {
  const ImageOptions options{.blur = 0.0, .noise = 2.0, .background = "plain"};
  const Camera camera = smallCamera();
  const cv::Mat picture =
      renderTarget(camera, apriltagTarget("tag36h11", {{.id = 4, .size = 0.1}}), pose({0, 0, 0}, {0, 0, -1}), options, 1, 1);
  cv::Scalar average, deviation;
  cv::meanStdDev(picture, average, deviation);
  const double pixels = camera.width * camera.height;
  const double expected = std::sqrt(4.0 + 1.0 / 12.0);  // and the rounding
  EXPECT_NEAR(deviation[0], expected, 4.0 * expected / std::sqrt(2.0 * pixels));
}

TEST(Renderer, TheLensBlursBeforeThePixelIntegrates) {
  // An edge along the pixels at u = 121.3: each pixel is the mean over its width of the normal distribution function, here by Simpson's
  // rule. What blurs sampled pixels instead makes the edge's place depend on where in a pixel it lies.
  constexpr int kIntervals = 200;
  Camera camera = smallCamera();
  camera.distortion.setZero();
  for (const double blur : {0.4, 0.7, 1.2}) {
    const ImageOptions options{.blur = blur, .noise = 0.0, .background = "plain"};
    const cv::Mat picture = renderTarget(camera, chessboardTarget(3, 3, 0.2), pose({0, 0, 0}, {0, 0, 1}), options, 1, 1);
    const int row = static_cast<int>(camera.cy) - 20;
    const double left = picture.at<std::uint8_t>(row, 105), right = picture.at<std::uint8_t>(row, 137);
    for (int u = 111; u < 132; ++u) {
      double share = 0.0;
      for (int k = 0; k <= kIntervals; ++k) {
        const double weight = k == 0 || k == kIntervals ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
        const double z = (u - 0.5 + static_cast<double>(k) / kIntervals - camera.cx) / blur;
        share += weight / (3.0 * kIntervals) * 0.5 * std::erfc(-z * M_SQRT1_2);
      }
      EXPECT_NEAR(picture.at<std::uint8_t>(row, u), left + share * (right - left), 0.5 + 0.02) << "blur " << blur << ", column " << u;
    }
  }
}

/// A tag about `side` pixels wide before a lens without distortion.
struct PosedTag {
  Camera camera = smallCamera();
  Target target = apriltagTarget("tag36h11", {{.id = 17, .size = 0.1}});
  Eigen::Isometry3d T_camera_target;

  PosedTag(const Eigen::Vector3d& rotation_vector, const Eigen::Vector2d& shift_px, double side) {
    camera.distortion.setZero();
    const double z = 0.1 * camera.fx / side;
    T_camera_target = pose(rotation_vector, {shift_px.x() * z / camera.fx, shift_px.y() * z / camera.fy, z});
  }
  test::Quad corners() const {
    test::Quad px;
    const Eigen::Matrix<double, 3, 4> p_target = tagCorners(0.1);
    for (int k = 0; k < 4; ++k) px.col(k) = *project(camera, T_camera_target * p_target.col(k));
    return px;
  }
};

TEST(Renderer, DrawsWhatAnotherRendererDraws) {
  // Ink 25 and paper 230, a homography from the corners, areas by Green's theorem, blurred on a fine grid: another way to the same greys.
  for (const Eigen::Vector3d& rotation : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.4, -0.3, 0.2), Eigen::Vector3d(-0.2, 0.5, 1.1)}) {
    for (const double blur : {0.5, 0.8}) {
      const PosedTag tag(rotation, {0.37, -0.21}, 90.0);
      const cv::Mat picture = renderTarget(tag.camera, tag.target, tag.T_camera_target, {.blur = blur, .noise = 0.0}, 1, 1);
      const cv::Mat exact = test::exactPicture(
          {.id = 17, .corners = tag.corners(), .blur = blur, .black = 25.0, .white = 230.0, .size = {tag.camera.width, tag.camera.height}});
      // The tag and half a cell of the paper about it, whose outer edge the other picture does not have.
      cv::Mat inside = cv::Mat::zeros(picture.size(), CV_8U);
      const test::Quad corners = tag.corners();
      const Eigen::Vector2d middle = corners.rowwise().mean();
      std::vector<cv::Point> outline;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector2d px = middle + 1.12 * (corners.col(k) - middle);
        outline.emplace_back(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y())));
      }
      cv::fillConvexPoly(inside, outline, cv::Scalar(255));
      cv::Mat greys;
      picture.convertTo(greys, CV_32F);
      // Rounding, and what the bilinear rays within a pixel bend.
      EXPECT_LT(cv::norm(greys, exact, cv::NORM_INF, inside), 0.6) << rotation.transpose() << ", blur " << blur;
      EXPECT_LT(cv::norm(greys, exact, cv::NORM_L2, inside) / std::sqrt(cv::countNonZero(inside)), 0.32) << "rounding alone leaves 0.29";
    }
  }
}

TEST(Renderer, RefinedCornersLieWhereTheyAreProjected) {
  // Tags along the pixels, where an alias would move whole sides, and tilted ones; noise of one grey level in place of plain rounding.
  constexpr int kTags = 12;
  TagRefiner refiner("tag36h11", true, std::nullopt);
  Rng rng = test::rngOfThisTest();
  for (const bool tilted : {false, true}) {
    double squares = 0.0, normalised = 0.0;
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    for (int trial = 0; trial < kTags; ++trial) {
      const Eigen::Vector3d rotation = tilted ? Eigen::Vector3d(test::uniformVector(rng, 3, 0.5)) : Eigen::Vector3d::Zero();
      const PosedTag tag(rotation, test::uniformVector(rng, 2, 3.0), rng.uniform(70.0, 90.0));
      const cv::Mat picture =
          renderTarget(tag.camera, tag.target, tag.T_camera_target, {.blur = 0.7, .noise = 1.0}, 1, static_cast<std::uint64_t>(trial));
      const std::optional<TagFit> fit = refiner.refine(picture, 17, tag.corners());
      ASSERT_TRUE(fit) << trial;
      const test::Quad error = fit->px - tag.corners();
      squares += error.squaredNorm() / 8.0;
      normalised += error.reshaped().dot(fit->covariance.ldlt().solve(Eigen::VectorXd(error.reshaped()))) / 8.0;
      shift += error.rowwise().mean();
    }
    EXPECT_LT(std::sqrt(squares / kTags), 0.004);
    // 96 normalised squares have a mean of 1 +- 0.15.
    EXPECT_LT(normalised / kTags, 1.5);
    EXPECT_LT((shift / kTags).cwiseAbs().maxCoeff(), 0.001);
  }
}

TEST(Renderer, SameSeedAndStreamGiveTheSamePicture) {
  const Camera camera = smallCamera();
  const Target tag = apriltagTarget("tag36h11", {{.id = 4, .size = 0.1}});
  const auto draw = [&](std::uint64_t seed, std::uint64_t stream) {
    return renderTarget(camera, tag, pose({0.1, 0.2, 0}, {0, 0, 0.4}), {}, seed, stream);
  };
  EXPECT_EQ(cv::norm(draw(1, 2), draw(1, 2), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(draw(1, 2), draw(1, 3), cv::NORM_INF), 20.0) << "another picture has another background";
  EXPECT_GT(cv::norm(draw(1, 2), draw(2, 2), cv::NORM_INF), 20.0);
}

TEST(Renderer, WrongOptionsAreErrors) {
  const Target tag = apriltagTarget("tag36h11", {{.id = 4, .size = 0.1}});
  const Eigen::Isometry3d T = pose({0, 0, 0}, {0, 0, 0.4});
  EXPECT_THROW(renderTarget(smallCamera(), tag, T, {.background = "forest"}, 1, 1), InvalidArgument);
  EXPECT_THROW(renderTarget(smallCamera(), tag, T, {.blur = -1.0}, 1, 1), InvalidArgument);
  EXPECT_THROW(renderTarget(smallCamera(), tag, T, {.noise = std::nan("")}, 1, 1), InvalidArgument);
}

}  // namespace
}  // namespace poecal
