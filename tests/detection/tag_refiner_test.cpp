// Corners of tags against those drawn: how far they are from the truth and from the limit, and when AprilTag's are kept.
#include "detection/tag_refiner.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "detection/rendering.hpp"
#include "detection/tag_appearance.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

const cv::Size kSize(200, 200);

test::Quad anyTag(Rng& rng, double smallest, double largest, double turn = 3.1) {
  const Eigen::Vector2d centre(rng.uniform(98.0, 102.0), rng.uniform(98.0, 102.0));
  return test::tiltedSquare(centre, rng.uniform(smallest, largest), rng.uniform(-turn, turn), rng.uniform(0.0, 0.6));
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

  void add(const test::Quad& truth, const TagDetection& before, const RefinedTag& after) {
    const test::Quad error = after.px - truth;
    const Eigen::Matrix<double, 8, 1> e = error.reshaped();
    apriltag += (before.px - truth).squaredNorm();
    refined += error.squaredNorm();
    predicted += 2.0 * after.sigma.squaredNorm();
    normalised += e.dot(after.fit->covariance.ldlt().solve(e)) / 8.0;
    shift += error.rowwise().mean();
    const test::Quad from_centre = truth.colwise() - truth.rowwise().mean();
    outward += error.cwiseProduct(from_centre.colwise().normalized()).sum() / 4.0;
    ++tags;
  }
  double ratio() const { return std::sqrt(refined / apriltag); }
};

struct Conditions {
  const char* name;
  double smallest, largest;  ///< [px]
  double blur, noise;        ///< [px], [grey levels]
  double turn;               ///< largest [rad]
};

std::string conditionsName(const ::testing::TestParamInfo<Conditions>& conditions) { return conditions.param.name; }

class RefinedCorners : public ::testing::TestWithParam<Conditions> {};

TEST_P(RefinedCorners, AreSeveralTimesNearerThanAprilTagsAndKnowHowFarTheyAreOff) {
  constexpr int kTags = 12;
  // Of AprilTag's own error; the noise alone leaves 0.2 at a noise of 4 levels, where AprilTag's 0.045 px meet a limit of 0.01.
  constexpr double kRatio = 0.25;
  // The mean of 96 squared and normalised errors is 1 +- 0.15; the renderer's 16 levels an edge and its blur after sampling add to it.
  constexpr double kLeast = 0.5, kMost = 2.0;
  constexpr double kBias = 0.005;  // [px]
  const Conditions& conditions = GetParam();
  Rng rng = test::rngOfThisTest();
  TagRefiner refiner("tag36h11", true, std::nullopt);
  Tally tally;
  for (int trial = 0; trial < kTags; ++trial) {
    const test::Quad truth = anyTag(rng, conditions.smallest, conditions.largest, conditions.turn);
    cv::Mat picture = test::tagPicture("tag36h11", static_cast<int>(rng.below(500)), truth, kSize);
    test::degrade(picture, rng, conditions.blur, conditions.noise);
    const std::optional<TagDetection> tag = detected(picture);
    ASSERT_TRUE(tag) << trial;
    const RefinedTag refined = refiner.refine(picture, *tag);
    ASSERT_TRUE(refined.fit) << trial;
    tally.add(truth, *tag, refined);
  }
  EXPECT_LT(tally.ratio(), kRatio);
  EXPECT_GT(tally.normalised / kTags, kLeast);
  EXPECT_LT(tally.normalised / kTags, kMost);
  EXPECT_LT((tally.shift / kTags).cwiseAbs().maxCoeff(), kBias);
  EXPECT_LT(std::abs(tally.outward / kTags), kBias);
}

INSTANTIATE_TEST_SUITE_P(Pictures, RefinedCorners,
                         ::testing::Values(Conditions{"Small", 40, 60, 0.7, 2.0, 3.1}, Conditions{"Large", 80, 110, 0.7, 2.0, 3.1},
                                           Conditions{"Soft", 50, 80, 1.2, 2.0, 3.1}, Conditions{"Noisy", 50, 80, 1.0, 4.0, 3.1}),
                         conditionsName);

TEST(Whiteness, DerivativesMatchCentralDifferences) {
  constexpr double kStep = 1e-5;       // truncation 1e-10 of the third derivative, rounding 1e-11
  constexpr double kTolerance = 1e-7;  // steps beyond reach are cut off at 3e-5 of their slope, at distances that no sample sits on
  Rng rng = test::rngOfThisTest();
  const TagPattern pattern("tag36h11", 17, true);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix2d J;
    J << rng.uniform(0.1, 0.25), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(0.1, 0.25);
    const Eigen::Vector2d uv(rng.uniform(1.0, 9.0), rng.uniform(1.0, 9.0));
    const double blur = rng.uniform(0.5, 1.2), growth = rng.uniform(-0.3, 0.3);
    const auto value = [&](const Eigen::Vector2d& at, double s, double g) { return whiteness(pattern, {at, J}, s, g).value; };
    const auto slope = [&](const Eigen::Vector2d& step, double s, double g) {
      return (value(uv + step, blur + s, growth + g) - value(uv - step, blur - s, growth - g)) / (2.0 * kStep);
    };
    const Eigen::Vector2d none = Eigen::Vector2d::Zero();
    const Whiteness white = whiteness(pattern, {uv, J}, blur, growth);
    Eigen::Vector4d analytic, numeric;
    analytic << white.J_value_uv.transpose(), white.J_value_blur, white.J_value_growth;
    numeric << slope({kStep, 0.0}, 0.0, 0.0), slope({0.0, kStep}, 0.0, 0.0), slope(none, kStep, 0.0), slope(none, 0.0, kStep);
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
    EXPECT_NEAR(whiteness(pattern, {uv, J}, 0.8, growth).value, whitenessBySummation(pattern, uv, J, 0.8, growth), kTolerance)
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
  const RefinedTag refined = TagRefiner("tag36h11", true, std::nullopt).refine(picture, *tag);
  ASSERT_TRUE(refined.fit);
  // A square of 3 x 3 grows an edge at 0.4 rad by more than a point: |cos| + |sin|.
  EXPECT_NEAR(refined.fit->growth, kGrowth * (std::cos(0.4) + std::sin(0.4)), kTolerance);
  EXPECT_THAT(refined.px, test::IsNear(truth, kTolerance));
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
  const RefinedTag refined = TagRefiner("tag36h11", true, std::nullopt).refine(picture, *tag);
  ASSERT_TRUE(refined.fit);
  EXPECT_THAT(refined.px, test::IsNear(truth, kTolerance));
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
  void expectRefused() {
    const RefinedTag refined = TagRefiner("tag36h11", true, std::nullopt).refine(picture_, *tag_);
    EXPECT_FALSE(refined.fit);
    EXPECT_THAT(refined.px, test::IsNear(tag_->px, 0.0));
    EXPECT_THAT(refined.sigma, test::IsNear(Eigen::Vector4d::Constant(unrefinedSigma(*tag_)).eval(), 0.0));
  }

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
  TagDetection tag;
  tag.px = test::tiltedSquare({50.0, 50.0}, 100.0, 0.1, 0.0);
  EXPECT_DOUBLE_EQ(unrefinedSigma(tag), 0.055);
  tag.px = test::tiltedSquare({50.0, 50.0}, 20.0, 0.1, 0.0);
  EXPECT_NEAR(unrefinedSigma(tag), 0.22, 1e-12);
}

}  // namespace
}  // namespace poecal
