// Corners of tags against those drawn: how far they are from the truth and from the limit, and when AprilTag's are kept.
#include "detection/tag_refiner.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>

#include "detection/corner_finder.hpp"
#include "detection/tag_appearance.hpp"
#include "detection/tag_detector.hpp"
#include "support/exact_tag.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/rendering.hpp"

namespace poecal {
namespace {

const cv::Size kSize(200, 200);

/// A tag of some size and angle somewhere about the middle of the picture.
test::TagScene anyScene(Rng& rng, double smallest, double largest, double blur) {
  test::TagScene scene;
  scene.id = static_cast<int>(rng.below(500));
  scene.blur = blur;
  scene.size = kSize;
  const Eigen::Vector2d centre(rng.uniform(98.0, 102.0), rng.uniform(98.0, 102.0));
  scene.corners = test::tiltedSquare(centre, rng.uniform(smallest, largest), rng.uniform(-3.1, 3.1), rng.uniform(0.0, 0.6));
  return scene;
}

/// What AprilTag itself would hand over.
std::optional<TagDetection> detected(const cv::Mat& picture, const std::string& family = "tag36h11") {
  const std::vector<TagDetection> tags = TagDetector(family).detect(picture, 2.0, true);
  if (tags.size() != 1) return std::nullopt;
  return tags.front();
}

/// Sums over many tags.
struct Tally {
  double apriltag = 0.0, refined = 0.0, normalised = 0.0, predicted = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double outward = 0.0;
  int tags = 0;

  void add(const test::Quad& truth, const TagDetection& before, const TagFit& after) {
    const test::Quad error = after.px - truth;
    const Eigen::Matrix<double, 8, 1> e = error.reshaped();
    apriltag += (before.px - truth).squaredNorm();
    refined += error.squaredNorm();
    predicted += 2.0 * after.sigmas().squaredNorm();
    normalised += e.dot(after.covariance.ldlt().solve(e)) / 8.0;
    shift += error.rowwise().mean();
    const test::Quad from_centre = truth.colwise() - truth.rowwise().mean();
    outward += error.cwiseProduct(from_centre.colwise().normalized()).sum() / 4.0;
    ++tags;
  }
  double rmsOf(double squares) const { return std::sqrt(squares / (8.0 * tags)); }
};

struct Conditions {
  const char* name;
  double smallest, largest;  ///< [px]
  double blur, noise;        ///< [px], [grey levels]
};

std::string conditionsName(const ::testing::TestParamInfo<Conditions>& conditions) { return conditions.param.name; }

class RefinedCorners : public ::testing::TestWithParam<Conditions> {};

TEST_P(RefinedCorners, AreSeveralTimesNearerThanAprilTagsAndKnowHowFarTheyAreOff) {
  constexpr int kTags = 12;
  // Of AprilTag's own error, or what is stated where noise alone leaves more: 96 errors of a fit of 8 numbers scatter by a tenth.
  constexpr double kOfAprilTags = 0.15, kOfStated = 1.3;
  constexpr double kLeast = 0.7, kMost = 1.4;  // the mean of 96 squared and normalised errors is 1 +- 0.15
  constexpr double kBias = 0.005;              // [px]
  const Conditions& conditions = GetParam();
  Rng rng = test::rngOfThisTest();
  TagRefiner refiner("tag36h11", true, std::nullopt);
  Tally tally;
  for (int trial = 0; trial < kTags; ++trial) {
    const test::TagScene scene = anyScene(rng, conditions.smallest, conditions.largest, conditions.blur);
    const cv::Mat picture = test::withNoise(test::exactPicture(scene), rng, conditions.noise);
    const std::optional<TagDetection> tag = detected(picture);
    ASSERT_TRUE(tag) << trial;
    const std::optional<TagFit> refined = refiner.refine(picture, tag->id, tag->px);
    ASSERT_TRUE(refined) << trial;
    tally.add(scene.corners, *tag, *refined);
  }
  EXPECT_LT(tally.rmsOf(tally.refined), std::max(kOfAprilTags * tally.rmsOf(tally.apriltag), kOfStated * tally.rmsOf(tally.predicted)));
  EXPECT_GT(tally.normalised / kTags, kLeast);
  EXPECT_LT(tally.normalised / kTags, kMost);
  EXPECT_LT((tally.shift / kTags).cwiseAbs().maxCoeff(), kBias);
  EXPECT_LT(std::abs(tally.outward / kTags), kBias);
}

TEST_P(RefinedCorners, AreAsExactAsThePictureAllows) {
  // Lines that agree by chance widen the covariance of one tag in three.
  constexpr double kOfLimit = 1.5;
  const Conditions& conditions = GetParam();
  Rng rng = test::rngOfThisTest();
  const test::TagScene scene = anyScene(rng, conditions.smallest, conditions.largest, conditions.blur);
  const cv::Mat picture = test::withNoise(test::exactPicture(scene), rng, conditions.noise);
  const std::optional<TagDetection> tag = detected(picture);
  ASSERT_TRUE(tag);
  const std::optional<TagFit> refined = TagRefiner("tag36h11", true, std::nullopt).refine(picture, tag->id, tag->px);
  ASSERT_TRUE(refined);
  const double limit = std::sqrt(test::cornerLimit(scene, conditions.noise).trace());
  const double stated = std::sqrt(refined->covariance.trace());
  EXPECT_LT(stated, kOfLimit * limit);
  EXPECT_GT(stated, 0.9 * limit) << "no estimate is better than the limit; noise found in one picture is uncertain by some hundredths";
}

INSTANTIATE_TEST_SUITE_P(Pictures, RefinedCorners,
                         ::testing::Values(Conditions{"Small", 40, 60, 0.7, 2.0}, Conditions{"Large", 80, 110, 0.7, 2.0},
                                           Conditions{"Sharp", 50, 80, 0.5, 1.0}, Conditions{"Soft", 50, 80, 1.2, 2.0},
                                           Conditions{"Noisy", 50, 80, 1.0, 4.0}),
                         conditionsName);

TEST(TagRefiner, PlaceInThePixelAndAngleDoNotMatter) {
  constexpr double kBias = 0.005;  // [px]; the pictures are rounded to grey levels and have no other noise
  Rng rng = test::rngOfThisTest();
  TagRefiner refiner("tag36h11", true, std::nullopt);
  for (int trial = 0; trial < 10; ++trial) {
    test::TagScene scene;
    scene.id = trial;
    scene.blur = 0.5;
    scene.size = {120, 120};
    const Eigen::Vector2d centre(60.0 + 0.13 * trial, 60.0 + 0.37 * trial - std::floor(0.37 * trial));
    // The first four lie along the pixels, where all of an edge sees the same place in them.
    scene.corners = test::tiltedSquare(centre, 61.7, trial < 4 ? 0.0 : 0.15 * trial, 0.0);
    const cv::Mat picture = test::withNoise(test::exactPicture(scene), rng, 0.0);
    const std::optional<TagDetection> tag = detected(picture);
    ASSERT_TRUE(tag) << trial;
    const std::optional<TagFit> refined = refiner.refine(picture, tag->id, tag->px);
    ASSERT_TRUE(refined) << trial;
    EXPECT_THAT(refined->px, test::IsNear(scene.corners, kBias)) << trial;
  }
}

TEST(Whiteness, DerivativesMatchCentralDifferences) {
  constexpr double kStep = 1e-5;  // truncation 1e-10 of the third derivative, rounding 1e-11
  // Of the tabulated normal distribution the second derivative is good to 2e-5, and a cell has up to ten blurs.
  constexpr double kTolerance = 5e-5;
  Rng rng = test::rngOfThisTest();
  const TagPattern pattern("tag36h11", 17, true);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix2d J;
    J << rng.uniform(0.1, 0.25), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(0.1, 0.25);
    const Eigen::Vector2d uv(rng.uniform(1.0, 9.0), rng.uniform(1.0, 9.0));
    const PointSpread spread{rng.uniform(0.5, 1.2), rng.uniform(-0.5, 0.5)};
    const double growth = rng.uniform(-0.3, 0.3);
    using Point = Eigen::Matrix<double, 5, 1>;  // u, v, blur, kurtosis, growth
    const auto value = [&](const Point& x) { return whiteness(pattern, {x.head<2>(), J}, {x(2), x(3)}, x(4)).value; };
    const Whiteness white = whiteness(pattern, {uv, J}, spread, growth);
    Point here, analytic, numeric;
    here << uv, spread.blur, spread.kurtosis, growth;
    analytic << white.J_value_uv.transpose(), white.J_value_blur, white.J_value_kurtosis, white.J_value_growth;
    for (Eigen::Index k = 0; k < 5; ++k) {
      const Point step = kStep * Point::Unit(k);
      numeric(k) = (value(here + step) - value(here - step)) / (2.0 * kStep);
    }
    EXPECT_THAT(analytic, test::IsNear(numeric, kTolerance)) << "trial " << trial << " at " << uv.transpose();
  }
}

/// Cells as they are, dark ones grown, under a Gaussian of the picture: summed over a fine grid.
double whitenessBySummation(const TagPattern& pattern, const Eigen::Vector2d& uv, const Eigen::Matrix2d& J, double blur, double growth) {
  constexpr int kHalf = 60;
  const Eigen::Vector2d slope = J.rowwise().norm();
  double sum = 0.0, weights = 0.0;
  for (int row = -kHalf; row <= kHalf; ++row) {
    for (int column = -kHalf; column <= kHalf; ++column) {
      const Eigen::Vector2d t = 4.0 / kHalf * Eigen::Vector2d(column, row);
      const Eigen::Vector2d at = uv + blur * J * t;
      int white = 1;
      for (const double du : {-growth, growth}) {
        for (const double dv : {-growth, growth}) {
          white &=
              pattern.white(static_cast<int>(std::floor(at.x() + du * slope.x())), static_cast<int>(std::floor(at.y() + dv * slope.y())));
        }
      }
      const double weight = std::exp(-0.5 * t.squaredNorm());
      weights += weight;
      sum += weight * white;
    }
  }
  return sum / weights;
}

TEST(Whiteness, IsTheBlurredPatternWithItsDarkPartsGrown) {
  constexpr double kTolerance = 0.01;  // half a step of the summation's grid, 0.033 blurs, times the slope of an edge, 0.4 a blur
  Rng rng = test::rngOfThisTest();
  const TagPattern pattern("tag36h11", 17, true);
  for (int trial = 0; trial < 60; ++trial) {
    Eigen::Matrix2d J;
    J << 0.2, rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06), 0.15;
    const Eigen::Vector2d uv(rng.uniform(2.0, 8.0), rng.uniform(2.0, 8.0));
    const double growth = rng.uniform(0.0, 0.3);
    EXPECT_NEAR(whiteness(pattern, {uv, J}, {0.8, 0.0}, growth).value, whitenessBySummation(pattern, uv, J, 0.8, growth), kTolerance)
        << "trial " << trial << " at " << uv.transpose() << ", growth " << growth;
  }
}

TEST(TagRefiner, GrowthOfDarkIntoLightIsNotTakenForSize) {
  // A fine picture's minimum over 3 x 3 points grows dark by one point, an eighth of a pixel, before it is made coarse.
  constexpr int kFine = 8;
  constexpr double kGrowth = 1.0 / kFine;
  constexpr double kTolerance = 0.02;  // [px]; taken for size, growth would move each corner by 0.18
  Rng rng = test::rngOfThisTest();
  const test::Quad truth = test::tiltedSquare({100.3, 99.6}, 90.0, 0.4, 0.3);
  const test::Quad truth_fine = (kFine * (truth.array() + 0.5) - 0.5).matrix();
  cv::Mat fine(kFine * kSize.height, kFine * kSize.width, CV_8UC1, cv::Scalar(255));
  const test::TagTexture texture = test::tagTexture("tag36h11", 7);
  const auto points = [](const test::Quad& quad) {
    std::vector<cv::Point2f> list;
    for (int k = 0; k < 4; ++k) list.emplace_back(static_cast<float>(quad(0, k)), static_cast<float>(quad(1, k)));
    return list;
  };
  cv::warpPerspective(texture.texture, fine, cv::getPerspectiveTransform(points(texture.corners), points(truth_fine)), fine.size(),
                      cv::INTER_NEAREST, cv::BORDER_TRANSPARENT);
  cv::erode(fine, fine, cv::Mat());
  cv::Mat picture;
  cv::resize(fine, picture, kSize, 0, 0, cv::INTER_AREA);
  test::degrade(picture, rng, 0.7, 1.0);
  const std::optional<TagDetection> tag = detected(picture);
  ASSERT_TRUE(tag);
  const std::optional<TagFit> refined = TagRefiner("tag36h11", true, std::nullopt).refine(picture, tag->id, tag->px);
  ASSERT_TRUE(refined);
  // A square of 3 x 3 grows an edge at 0.4 rad by more than a point: |cos| + |sin|.
  EXPECT_NEAR(refined->growth, kGrowth * (std::cos(0.4) + std::sin(0.4)), kTolerance);
  EXPECT_THAT(refined->px, test::IsNear(truth, kTolerance));
}

// Upright before the camera, as renderers draw them: all pixels of an edge say the same, and rounding is all the noise there is.
TEST(TagRefiner, UprightTagsWithoutNoiseComeToRest) {
  constexpr double kTolerance = 0.01;   // [px]; AprilTag's corners are 0.15 off there
  constexpr double kOfAprilTags = 0.2;  // where the picture is sharper than its pixels, and says less
  Rng rng = test::rngOfThisTest();
  TagRefiner refiner("tag36h11", true, std::nullopt);
  const auto errorsOf = [&](double side, double off, double blur) {
    test::TagScene scene;
    scene.id = 7;
    scene.blur = blur;
    scene.size = {400, 400};
    scene.corners = test::tiltedSquare({200.0 + off, 200.0 + off}, side, 0.0, 0.0);
    const cv::Mat picture = test::withNoise(test::exactPicture(scene), rng, 0.0);
    const std::optional<TagDetection> tag = detected(picture);
    const std::optional<TagFit> fit = tag ? refiner.refine(picture, tag->id, tag->px) : std::nullopt;
    EXPECT_TRUE(fit) << side << " px, " << off << ", blur " << blur;
    const auto error = [&](const TagCorners& px) { return (px - scene.corners).colwise().norm().maxCoeff(); };
    return fit ? std::pair(error(tag->px), error(fit->px)) : std::pair(0.0, 1.0);
  };
  for (const double off : {0.0, 0.25, 0.5}) {
    for (const double side : {100.0, 200.0, 320.0}) EXPECT_LT(errorsOf(side, off, 0.7).second, kTolerance) << side << " px, " << off;
  }
  for (const double off : {0.0, 0.5}) {
    const auto [apriltags, refined] = errorsOf(100.0, off, 0.1);
    EXPECT_LT(refined, kOfAprilTags * apriltags) << off;
  }
}

TEST(TagRefiner, AGlareSpotDoesNotPull) {
  constexpr double kTolerance = 0.03;  // [px], three times the error without the spot and half of AprilTag's
  Rng rng = test::rngOfThisTest();
  const test::Quad truth = test::tiltedSquare({100.0, 100.0}, 100.0, 0.3, 0.2);
  cv::Mat picture = test::tagPicture("tag36h11", 7, truth, kSize);
  test::degrade(picture, rng, 0.7, 1.0);
  const std::optional<TagDetection> tag = detected(picture);
  ASSERT_TRUE(tag);
  cv::circle(picture, {60, 102}, 7, cv::Scalar(255), cv::FILLED);
  const std::optional<TagFit> refined = TagRefiner("tag36h11", true, std::nullopt).refine(picture, tag->id, tag->px);
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->px, test::IsNear(truth, kTolerance));
}

/// Pictures that are no sharp, whole tag.
class RefusedPicture : public ::testing::Test {
 protected:
  void SetUp() override {
    picture_ = test::tagPicture("tag36h11", 7, truth_, kSize);
    test::degrade(picture_, rng_, 0.7, 1.0);
    tag_ = detected(picture_);
    ASSERT_TRUE(tag_);
  }
  void expectRefused() { EXPECT_FALSE(TagRefiner("tag36h11", true, std::nullopt).refine(picture_, tag_->id, tag_->px)); }

  Rng rng_ = test::rngOfThisTest();
  test::Quad truth_ = test::tiltedSquare({100.0, 100.0}, 80.0, 0.2, 0.2);
  cv::Mat picture_;
  std::optional<TagDetection> tag_;
};

TEST_F(RefusedPicture, HalfCovered) {
  picture_.colRange(0, 100).setTo(128);
  expectRefused();
}

TEST_F(RefusedPicture, MovedDuringTheExposure) {
  cv::blur(picture_, picture_, {9, 1});
  expectRefused();
}

TEST_F(RefusedPicture, AnotherTagThanWasRead) {
  tag_->id = 8;
  expectRefused();
}

TEST_F(RefusedPicture, CornersFarOff) {
  tag_->px.array() += 1.5;
  expectRefused();
}

TEST_F(RefusedPicture, HardlyAnyContrast) {
  picture_.convertTo(picture_, CV_8U, 0.1, 100.0);
  expectRefused();
}

TEST_F(RefusedPicture, BeyondTheBorder) {
  picture_ = picture_.colRange(static_cast<int>(truth_.row(0).minCoeff()) + 1, kSize.width).clone();
  tag_->px.row(0).array() -= std::floor(truth_.row(0).minCoeff()) + 1.0;
  expectRefused();
}

TEST(TagRefiner, SmallTagsLeftUnrefinedStateALargerSigma) {
  EXPECT_DOUBLE_EQ(unrefinedSigma(test::tiltedSquare({50.0, 50.0}, 100.0, 0.1, 0.0)), 0.055);
  EXPECT_NEAR(unrefinedSigma(test::tiltedSquare({50.0, 50.0}, 20.0, 0.1, 0.0)), 0.22, 1e-12);
}

TEST(TagRefiner, CornersWithoutAFitAreAprilTagsWithTheirOwnSigma) {
  const test::Quad truth = test::tiltedSquare({100.0, 100.0}, 80.0, 0.2, 0.2);
  cv::Mat picture = test::tagPicture("tag36h11", 7, truth, kSize);
  cv::blur(picture, picture, {9, 1});
  const std::optional<TagDetection> tag = detected(picture);
  ASSERT_TRUE(tag);
  const auto finder = makeAprilTagFinder(apriltagTarget("tag36h11", {{7, 0.1, Eigen::Isometry3d::Identity()}}), {});
  const FoundCorners finding = finder->find(picture);
  ASSERT_EQ(finding.corners.size(), 4u);
  for (const Corner& corner : finding.corners) {
    EXPECT_THAT(corner.px, test::IsNear(tag->px.col(corner.id.corner).eval(), 0.0));
    EXPECT_DOUBLE_EQ(corner.sigma, unrefinedSigma(tag->px));
  }
}

}  // namespace
}  // namespace poecal
