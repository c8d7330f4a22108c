#include "poecal/camera/intrinsics.hpp"

#include <cmath>
#include <map>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
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
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

IntrinsicsResult calibrated(const Camera& truth, const std::vector<BoardView>& views, bool robust = true) {
  IntrinsicsOptions options;
  options.model = truth.model;
  options.robust = robust;
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

/// Where `b` sees the ray of `a`'s pixel, less that pixel, with b turned as fits best over the picture (Gauss-Newton on numeric columns).
Eigen::Vector2d differenceUpToATurn(const Camera& a, const Camera& b, const Eigen::Vector2d& at) {
  const auto moved = [&](const Eigen::Vector2d& px, const Eigen::Vector3d& turn) {
    return Eigen::Vector2d(*project(b, expSo3(turn) * *unproject(a, px)) - px);
  };
  constexpr double kStep = 1e-6;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (int v = 26; v < a.height; v += 53) {
      for (int u = 26; u < a.width; u += 53) {
        const Eigen::Vector2d px(u, v), r = moved(px, turn);
        Eigen::Matrix<double, 2, 3> J;
        for (int k = 0; k < 3; ++k) J.col(k) = (moved(px, turn + kStep * Eigen::Vector3d::Unit(k)) - r) / kStep;
        H += J.transpose() * J;
        g += J.transpose() * r;
      }
    }
    turn -= H.inverse() * g;
  }
  return moved(at, turn);
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
    EXPECT_THAT(result.robust.camera.parameters(), IsNear(result.all.camera.parameters(), 1e-9)) << "rounding makes no outliers";
    EXPECT_EQ(result.robust.outliers, 0);
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

/// Corners as uncertain as they state, from 0.02 to 0.4 px, and beside that by `floor` [px].
std::vector<BoardView> unevenly(std::vector<BoardView> views, double floor, Rng& rng) {
  for (BoardView& view : views) {
    view.sigmas.resize(view.points.cols());
    for (Eigen::Index i = 0; i < view.points.cols(); ++i) {
      view.sigmas(i) = 0.02 * std::pow(20.0, rng.uniform());
      view.pixels.col(i) += std::hypot(view.sigmas(i), floor) * Eigen::Vector2d(rng.normal(), rng.normal());
    }
  }
  return views;
}

TEST(IntrinsicsStatistics, CornersWeighAsTheirSigmasSay) {
  // Each trial's nine squared and normalised errors are 9 +- 4.2 in sum, their mean over 24 trials 1 +- 0.1.
  constexpr int kTrials = 24;
  constexpr double kLeast = 0.7, kMost = 1.4;
  const Camera truth = test::plumbBobCamera();
  for (const double floor : {0.0, 0.1}) {
    double normalised = 0.0, weighted = 0.0, alike = 0.0;
    for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
      Rng rng = test::rngOfThisTest(trial);
      std::vector<BoardView> views = unevenly(test::boardScene(truth, 10, rng).views, floor, rng);
      const IntrinsicsFit fit = calibrated(truth, views).robust;
      const Eigen::VectorXd error = fit.camera.parameters() - truth.parameters();
      normalised += error.dot(fit.covariance.ldlt().solve(error)) / static_cast<double>(error.size()) / kTrials;
      weighted += error.head<4>().squaredNorm();
      for (BoardView& view : views) view.sigmas.resize(0);
      alike += (calibrated(truth, views).robust.camera.parameters() - truth.parameters()).head<4>().squaredNorm();
    }
    EXPECT_GT(normalised, kLeast) << floor;
    EXPECT_LT(normalised, kMost) << floor;
    // The mean of 1 / sigma^2 is 11 times the inverse of that of sigma^2, of which the loss of weight of the worst corners gains a part
    // already; with a floor of 0.1 px little is left to gain.
    EXPECT_LT(weighted, (floor == 0.0 ? 0.4 : 1.0) * alike) << floor;
  }
}

TEST(Intrinsics, SigmasMustBePositiveAndAsManyAsPoints) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  std::vector<BoardView> views = test::boardScene(truth, 4, rng).views;
  views[1].sigmas = Eigen::VectorXd::Ones(3);
  EXPECT_THAT([&] { calibrated(truth, views); }, ThrowsMessage<InvalidArgument>(HasSubstr("3 sigmas of 35 points")));
  views[1].sigmas = Eigen::VectorXd::Zero(35);
  EXPECT_THAT([&] { calibrated(truth, views); }, ThrowsMessage<InvalidArgument>(HasSubstr("a positive one for each")));
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
  const IntrinsicsResult result = calibrated(truth, views);
  for (std::size_t v = 0; v < views.size(); ++v) EXPECT_EQ(result.views[v].left_out, v == 4) << v;
  EXPECT_TRUE(result.views[4].bad);
  EXPECT_EQ(result.all.pictures, 12);
  EXPECT_EQ(result.robust.pictures, 11);
  EXPECT_EQ(result.chosen().pictures, 11);
  EXPECT_GT(result.all.rms_px, 0.4);                                             // 1.5 px sqrt(2 / 12) = 0.6 px
  EXPECT_NEAR(result.robust.sigma_px, 0.1, 0.1 * 4.0 / std::sqrt(2.0 * 700.0));  // four standard errors of a deviation of 700 numbers
  EXPECT_THAT(result.warnings, Contains(HasSubstr("bad pictures: view-4")));
  const IntrinsicsResult plain = calibrated(truth, views, false);
  EXPECT_TRUE(plain.views[4].bad) << "named all the same";
  EXPECT_EQ(plain.chosen().pictures, 12);
  EXPECT_EQ(plain.chosen().camera.parameters(), plain.all.camera.parameters());
}

TEST(Intrinsics, WildCornersLoseTheirWeightAndTheirPicturesStay) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  std::vector<BoardView> views = test::noisy(test::boardScene(truth, 12, rng).views, 0.1, rng);
  const IntrinsicsResult clean = calibrated(truth, views);
  // One corner in every second picture, by 1 to 40 px.
  for (std::size_t v = 0; v < views.size(); v += 2)
    views[v].pixels(0, static_cast<Eigen::Index>(3 * v)) += std::pow(1.85, static_cast<double>(v) / 2.0 + 1.0);
  const IntrinsicsResult result = calibrated(truth, views);
  for (const ViewResidual& view : result.views) EXPECT_FALSE(view.bad) << view.image;
  EXPECT_GE(result.robust.outliers, 6);
  EXPECT_LE(result.robust.outliers, 6 + 10);  // of 420 corners of normal noise some 4 are beyond 3 deviations
  EXPECT_EQ(result.views[2].outliers, 1);
  EXPECT_NEAR(result.robust.sigma_px, 0.1, 0.1 * 4.0 / std::sqrt(2.0 * 750.0));
  // What six corners of 420 took away and their weights near the edge moved, against what the noise leaves open.
  const Eigen::VectorXd moved = result.robust.camera.parameters() - clean.robust.camera.parameters();
  EXPECT_LT((moved.array() / clean.robust.camera.standard_deviation.array()).abs().maxCoeff(), 1.0);
  EXPECT_GT(std::abs(result.all.camera.fx - clean.all.camera.fx), 3.0 * clean.all.camera.standard_deviation(0))
      << "or the test proves nothing";
  EXPECT_THAT(result.warnings, Contains(HasSubstr("corners count for little or nothing")));
}

TEST(Intrinsics, APictureOfSomeWildCornersIsNamedAndItsOthersCount) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  std::vector<BoardView> views = test::noisy(test::boardScene(truth, 12, rng).views, 0.1, rng);
  for (Eigen::Index corner = 0; corner < 7; ++corner) views[3].pixels.col(5 * corner) += Eigen::Vector2d(4.0, -3.0);
  const IntrinsicsResult result = calibrated(truth, views);
  for (std::size_t v = 0; v < views.size(); ++v) EXPECT_EQ(result.views[v].bad, v == 3) << v;
  EXPECT_FALSE(result.views[3].left_out);
  EXPECT_EQ(result.views[3].outliers, 7);
  EXPECT_EQ(result.robust.pictures, 12);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("7 of 35 corners")));
}

TEST(Intrinsics, RobustnessCostsLittleWhereNothingIsWrong) {
  const Camera truth = test::plumbBobCamera();
  Rng rng = test::rngOfThisTest();
  double plain = 0.0, robust = 0.0, stated = 0.0;
  constexpr int kTrials = 12, kParameters = 9;
  for (int trial = 0; trial < kTrials; ++trial) {
    const IntrinsicsResult result = calibrated(truth, test::noisy(test::boardScene(truth, 10, rng).views, 0.2, rng));
    const Eigen::MatrixXd information = result.all.covariance.inverse();
    const Eigen::VectorXd e = result.all.camera.parameters() - truth.parameters(),
                          d = result.robust.camera.parameters() - truth.parameters();
    plain += e.dot(information * e);
    robust += d.dot(information * d);
    stated += d.dot(result.robust.covariance.inverse() * d);
  }
  // Chi-square of 108: 108 +- 15.
  EXPECT_NEAR(plain, kTrials * kParameters, 4.0 * 15.0);
  EXPECT_LT(robust, 1.15 * plain);
  EXPECT_NEAR(stated, kTrials * kParameters, 4.0 * 15.0);
}

TEST(Intrinsics, PicturesThatPullMakeTheStatedDeviationsLarger) {
  // A board bent by 1 mm, which corners cannot tell from noise in their middle but pictures can.
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  test::BoardScene scene = test::boardScene(truth, 14, rng);
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    for (Eigen::Index i = 0; i < 35; ++i) {
      Eigen::Vector3d p = scene.views[v].points.col(i);
      p.z() = 1e-3 * (1.0 - std::pow(p.x() / 0.105, 2.0));
      scene.views[v].pixels.col(i) = *project(truth, scene.T_camera_target[v] * p);
    }
  }
  const IntrinsicsResult result = calibrated(truth, test::noisy(scene.views, 0.1, rng));
  EXPECT_GT(result.robust.camera.standard_deviation(0), 1.5 * result.all.camera.standard_deviation(0));
  EXPECT_LT(std::abs(result.robust.camera.fx - truth.fx), 3.0 * result.robust.camera.standard_deviation(0));
}

TEST(IntrinsicsStatistics, UncertaintyIsWhatOtherNoiseMoves) {
  const Camera truth = test::plumbBobCamera();
  Rng rng = test::rngOfThisTest();
  const std::vector<BoardView> exact = test::boardScene(truth, 10, rng).views;
  ProjectionUncertainty stated;
  std::vector<Camera> found;
  for (int trial = 0; trial < 40; ++trial) {
    const IntrinsicsResult result = calibrated(truth, test::noisy(exact, 0.2, rng), false);
    if (trial == 0) stated = result.all.uncertainty;
    found.push_back(result.all.camera);
  }
  // At one cell of the grid, the turn that fits the whole picture best taken off numerically.
  double largest = 0.0;
  for (const Eigen::Vector2d& px :
       {Eigen::Vector2d(26.2, 26.2), Eigen::Vector2d(612.8, 452.8), Eigen::Vector2d(612.8, 26.2), Eigen::Vector2d(26.2, 452.8)}) {
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const Camera& camera : found)
      covariance += differenceUpToATurn(truth, camera, px) * differenceUpToATurn(truth, camera, px).transpose();
    largest = std::max(largest, std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance / 40.0).eigenvalues()(1)));
  }
  EXPECT_NEAR(stated.largest_px, largest, 0.35 * largest);  // of a deviation of 40 trials: 11 %, three times
  EXPECT_LT(stated.median_px, stated.largest_px);
}

TEST(Intrinsics, CoefficientsThatThePicturesDoNotDetermineAreNamed) {
  // Without distortion numerator and denominator of the rational model may be anything, as long as they are the same.
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::makeCamera(DistortionModel::kRationalPolynomial, std::vector<double>(8, 0.0));
  const IntrinsicsResult result = calibrated(truth, test::noisy(test::boardScene(truth, 6, rng).views, 0.1, rng));
  EXPECT_THAT(result.warnings, Contains(HasSubstr("open: any value fits, so they are held at 0")));
  EXPECT_THAT(result.robust.held, Contains("k6"));
  const std::vector<std::string> names = truth.parameterNames();
  for (Eigen::Index k = 4; k < truth.parameterCount(); ++k) {
    const double value = result.robust.camera.parameters()(k), deviation = result.robust.camera.standard_deviation(k);
    const bool held = testing::Value(result.robust.held, Contains(names[static_cast<std::size_t>(k)]));
    EXPECT_EQ(std::isnan(deviation), held) << k;
    EXPECT_LT(std::abs(value), held ? 1e-300 : 4.0 * deviation) << k;
  }
  EXPECT_NEAR(result.robust.camera.fx, truth.fx, 4.0 * result.robust.camera.standard_deviation(0));
  for (const double u : {26.0, 613.0}) {
    for (const double v : {26.0, 453.0}) {
      EXPECT_LT(differenceUpToATurn(truth, result.robust.camera, {u, v}).norm(), 4.0 * result.robust.uncertainty.largest_px);
    }
  }
}

TEST(Intrinsics, PicturesThatWereStretchedAreSaid) {
  Rng rng = test::rngOfThisTest();
  Camera camera = test::plumbBobCamera();
  const auto warnings = [&] { return calibrated(camera, test::noisy(test::boardScene(camera, 12, rng).views, 0.1, rng)).warnings; };
  EXPECT_THAT(warnings(), ::testing::Not(Contains(HasSubstr("square pixels"))));
  camera.fy *= 0.95;
  EXPECT_THAT(warnings(), Contains(HasSubstr("of fx, expected square pixels: were the pictures stretched")));
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

TEST(Intrinsics, TellHowFarTheyAreAndCanBeStoppedAnywhere) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  const std::vector<BoardView> views = test::noisy(test::boardScene(truth, 8, rng).views, 0.1, rng);
  std::map<std::string, std::vector<std::size_t>> left;  // pieces of each job, when it was told
  int calls = 0, stop_at = 1000;
  IntrinsicsOptions options;
  options.progress = [&](const std::string& label, std::size_t done, std::size_t total) {
    if (++calls >= stop_at) throw std::runtime_error("enough at " + std::to_string(calls));
    left[label].push_back(total - done);
  };
  const IntrinsicsResult told = calibrateIntrinsics(views, truth.width, truth.height, options);
  EXPECT_EQ(told.chosen().camera.parameters(), calibrated(truth, views).chosen().camera.parameters());
  EXPECT_THAT(left["fitting the lens"], ElementsAre(6, 5, 4, 3, 2, 1, 0));
  EXPECT_EQ(left["fitting the lens without outliers"].back(), 0u);
  EXPECT_EQ(left["judging each picture of the board"].front(), views.size());
  EXPECT_EQ(left["judging each picture of the board"].back(), 0u);
  const int all = calls;
  for (const int stop : {1, all / 2, all}) {
    calls = 0;
    stop_at = stop;
    EXPECT_THAT([&] { calibrateIntrinsics(views, truth.width, truth.height, options); },
                ThrowsMessage<std::runtime_error>("enough at " + std::to_string(stop)));
  }
}

}  // namespace
}  // namespace poecal
