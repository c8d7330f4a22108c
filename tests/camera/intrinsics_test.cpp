#include "poecal/camera/intrinsics.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>

#include "camera/camera_examples.hpp"
#include "camera/synthetic_boards.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::IsNear;
using testing::Contains;
using testing::HasSubstr;
using testing::ThrowsMessage;

IntrinsicsResult calibrated(const Camera& truth, const std::vector<BoardView>& views, bool drop_bad = false) {
  IntrinsicsOptions options;
  options.model = truth.model;
  options.drop_bad = drop_bad;
  return calibrateIntrinsics(views, truth.width, truth.height, options);
}

/// Largest distance over the picture between where two cameras see the same rays [px].
double largestPixelDifference(const Camera& a, const Camera& b) {
  double largest = 0.0;
  for (int v = 20; v < a.height; v += 55) {
    for (int u = 20; u < a.width; u += 60) {
      const auto ray = unproject(a, Eigen::Vector2d(u, v));
      const auto px = ray ? project(b, *ray) : std::nullopt;
      largest = std::max(largest, px ? (*px - Eigen::Vector2d(u, v)).norm() : 1e9);
    }
  }
  return largest;
}

TEST(Intrinsics, ExactCornersGiveTheCameraBack) {
  for (const Camera& truth : {test::plumbBobCamera(), test::equidistantCamera()}) {
    Rng rng = test::rngOfThisTest();
    const test::BoardScene scene = test::boardScene(truth, 8, rng);
    const IntrinsicsResult result = calibrated(truth, scene.views);
    EXPECT_TRUE(result.all.converged);
    EXPECT_LT(result.all.rms_px, 1e-9);
    EXPECT_THAT(result.all.camera.parameters(), IsNear(truth.parameters(), 1e-6))
        << distortionModelName(truth.model);  // of 500: 1e-8 relative
    EXPECT_FALSE(result.without_bad);
    for (std::size_t v = 0; v < scene.views.size(); ++v) {
      EXPECT_THAT(result.views[v].T_camera_target, test::PoseIsNear(scene.T_camera_target[v], 1e-8));
    }
  }
}

TEST(Intrinsics, ExactCornersGiveTheRationalLensBackAsAWhole) {
  // Numerator and denominator of this lens nearly cancel: the coefficients are known to fewer digits than the pixels they make.
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::rationalCamera();
  const IntrinsicsResult result = calibrated(truth, test::boardScene(truth, 10, rng).views);
  EXPECT_LT(result.all.rms_px, 1e-6);
  EXPECT_LT(largestPixelDifference(truth, result.all.camera), 1e-3);
}

TEST(Intrinsics, AgreesWithOpenCvOnNoisyCorners) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  const std::vector<BoardView> views = test::noisy(test::boardScene(truth, 10, rng).views, 0.2, rng);
  const IntrinsicsResult result = calibrated(truth, views);
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardView& view : views) {
    points.emplace_back();
    pixels.emplace_back();
    for (Eigen::Index i = 0; i < view.points.cols(); ++i) {
      points.back().emplace_back(view.points.col(i).x(), view.points.col(i).y(), 0.0F);
      pixels.back().emplace_back(view.pixels.col(i).x(), view.pixels.col(i).y());
    }
  }
  cv::Mat K, k, r, t, deviations, more, per_view;
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-15);
  const double rms = cv::calibrateCamera(points, pixels, {640, 480}, K, k, r, t, deviations, more, per_view, 0, criteria);
  // OpenCV takes corners as floats: some 1e-5 px.
  EXPECT_NEAR(result.all.rms_px, rms, 1e-5);
  EXPECT_NEAR(result.all.camera.fx, K.at<double>(0, 0), 1e-2);
  EXPECT_NEAR(result.all.camera.cy, K.at<double>(1, 2), 1e-2);
  // OpenCV 4.6 divides the squared error by points - unknowns where there are twice as many numbers as points.
  const double points_total = 350.0, unknowns = 9.0 + 6.0 * 10.0;
  const double overstated = std::sqrt((2.0 * points_total - unknowns) / (points_total - unknowns));
  for (int i = 0; i < 9; ++i) {
    const double expected = deviations.at<double>(i) / overstated;
    EXPECT_NEAR(result.all.camera.standard_deviation(i), expected, 0.01 * expected) << i;
  }
}

TEST(Intrinsics, ABoardThatIsNotFlatNeedsNoTilt) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  test::BoardScene scene = test::boardScene(truth, 6, rng, 0.0);
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    for (Eigen::Index i = 0; i < 35; ++i) {
      scene.views[v].points(2, i) = 0.02 * static_cast<double>(i % 3);
      scene.views[v].pixels.col(i) = *project(truth, scene.T_camera_target[v] * scene.views[v].points.col(i));
    }
  }
  EXPECT_THAT(calibrated(truth, scene.views).all.camera.parameters(), IsNear(truth.parameters(), 1e-5));
}

TEST(Intrinsics, NamesTheBadPictureAndWhatBecomesOfTheRest) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  std::vector<BoardView> views = test::noisy(test::boardScene(truth, 12, rng).views, 0.1, rng);
  const std::vector<BoardView> one = test::noisy({views[4]}, 1.5, rng);
  views[4] = one[0];
  const IntrinsicsResult kept = calibrated(truth, views);
  for (std::size_t v = 0; v < views.size(); ++v) EXPECT_EQ(kept.views[v].bad, v == 4) << v;
  ASSERT_TRUE(kept.without_bad);
  EXPECT_EQ(kept.all.pictures, 12);
  EXPECT_EQ(kept.without_bad->pictures, 11);
  EXPECT_EQ(kept.chosen().pictures, 12);
  EXPECT_GT(kept.all.rms_px, 0.4);                                                   // 1.5 px sqrt(2 / 12) = 0.6 px
  EXPECT_NEAR(kept.without_bad->sigma_px, 0.1, 0.1 * 4.0 / std::sqrt(2.0 * 700.0));  // four standard errors of a deviation of 700 numbers
  EXPECT_THAT(kept.warnings, Contains(HasSubstr("bad pictures: view-4")));
  const IntrinsicsResult dropped = calibrated(truth, views, true);
  EXPECT_EQ(dropped.chosen().pictures, 11);
  EXPECT_EQ(dropped.chosen().camera.parameters(), kept.without_bad->camera.parameters());
}

TEST(Intrinsics, CoefficientsThatThePicturesDoNotDetermineAreNamed) {
  // Without distortion numerator and denominator of the rational model may be anything, as long as they are the same.
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::makeCamera(DistortionModel::kRationalPolynomial, std::vector<double>(8, 0.0));
  const IntrinsicsResult result = calibrated(truth, test::noisy(test::boardScene(truth, 6, rng).views, 0.1, rng));
  EXPECT_THAT(result.warnings, Contains(testing::AnyOf(HasSubstr("k6 = "), HasSubstr("leave k6 open"))));
  EXPECT_NEAR(result.all.camera.fx, truth.fx, 4.0 * result.all.camera.standard_deviation(0));
}

TEST(Intrinsics, NeverSetsAsideMoreThanAQuarter) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  std::vector<BoardView> views = test::noisy(test::boardScene(truth, 8, rng).views, 0.1, rng);
  for (const std::size_t v : {1U, 3U, 6U}) views[v] = test::noisy({views[v]}, 5.0, rng)[0];
  const IntrinsicsResult result = calibrated(truth, views);
  EXPECT_LE(std::count_if(result.views.begin(), result.views.end(), [](const ViewResidual& v) { return v.bad; }), 2);
}

TEST(Intrinsics, PicturesWithTooFewPointsAreNamedAndLeftOut) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  std::vector<BoardView> views = test::boardScene(truth, 7, rng).views;
  views[2].points = views[2].points.leftCols(3).eval();
  views[2].pixels = views[2].pixels.leftCols(3).eval();
  views[5].points = views[5].points.leftCols(7).eval();  // one row of the board: a line
  views[5].pixels = views[5].pixels.leftCols(7).eval();
  const IntrinsicsResult result = calibrated(truth, views);
  EXPECT_FALSE(result.views[2].used);
  EXPECT_FALSE(result.views[5].used);
  EXPECT_EQ(result.all.pictures, 5);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("view-2 is not used: 3 points")));
  EXPECT_THAT(result.warnings, Contains(HasSubstr("view-5 is not used: 7 points")));
}

TEST(Intrinsics, BoardsParallelToThePictureDoNotDetermineTheFocalLength) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  const std::vector<BoardView> views = test::boardScene(truth, 6, rng, 0.0).views;
  EXPECT_THAT([&] { calibrated(truth, views); }, ThrowsMessage<InsufficientData>(HasSubstr("tilts")));
}

TEST(Intrinsics, TooLittleDataAndBadCallsAreErrors) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  const std::vector<BoardView> views = test::boardScene(truth, 3, rng).views;
  EXPECT_THAT([&] { calibrated(truth, {}); },
              ThrowsMessage<InsufficientData>(HasSubstr("0 usable pictures of the board, expected at least 3")));
  EXPECT_THAT([&] { calibrated(truth, {views[0], views[1]}); }, ThrowsMessage<InsufficientData>(HasSubstr("2 usable pictures")));
  std::vector<BoardView> four_corners;
  for (const BoardView& view : views) {
    BoardView& brief = four_corners.emplace_back();
    brief.points.resize(3, 4);
    brief.pixels.resize(2, 4);
    int column = 0;
    for (const Eigen::Index i : {0, 6, 28, 34}) {
      brief.points.col(column) = view.points.col(i);
      brief.pixels.col(column++) = view.pixels.col(i);
    }
  }
  EXPECT_THAT([&] { calibrated(truth, four_corners); },
              ThrowsMessage<InsufficientData>(HasSubstr("12 points in 3 pictures give 24 numbers for 27 unknowns")));
  BoardView uneven = views[0];
  uneven.pixels = uneven.pixels.leftCols(5).eval();
  EXPECT_THAT([&] { calibrated(truth, {uneven}); }, ThrowsMessage<InvalidArgument>(HasSubstr("35 points and 5 pixels")));
  EXPECT_THROW(calibrateIntrinsics(views, 0, 480, {}), InvalidArgument);
  IntrinsicsOptions options;
  options.bad_view_factor = 0.5;
  EXPECT_THAT([&] { options.validate(); }, ThrowsMessage<InvalidArgument>(HasSubstr("bad_view_factor is 0.5")));
}

}  // namespace
}  // namespace poecal
