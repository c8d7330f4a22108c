#include "camera/board_bundle.hpp"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>

#include "camera/camera_examples.hpp"
#include "camera/intrinsics_judgement.hpp"
#include "camera/synthetic_boards.hpp"
#include "poecal/core/statistics.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::IsNear;

std::vector<const BoardView*> pointersTo(const std::vector<BoardView>& views) {
  std::vector<const BoardView*> pointers;
  for (const BoardView& view : views) pointers.push_back(&view);
  return pointers;
}

std::vector<int> firstParameters(int count) {
  std::vector<int> indices(static_cast<std::size_t>(count));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

TEST(BoardBundle, TheTruthStays) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  const test::BoardScene scene = test::boardScene(truth, 4, rng);
  const auto fit = fitBoardBundle(pointersTo(scene.views), {truth, scene.T_camera_target}, firstParameters(9), 20);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->converged);
  EXPECT_THAT(fit->estimate.camera.parameters(), IsNear(truth.parameters(), 1e-9));
}

TEST(BoardBundle, APerturbedStartComesBack) {
  for (const Camera& truth : {test::plumbBobCamera(), test::equidistantCamera()}) {
    Rng rng = test::rngOfThisTest();
    const test::BoardScene scene = test::boardScene(truth, 6, rng);
    BoardBundle start{truth, scene.T_camera_target};
    start.camera.fx *= 1.05;
    start.camera.cy += 10.0;
    start.camera.distortion *= 0.8;
    for (Eigen::Isometry3d& T : start.T_camera_target) T = test::randomPose(rng, 0.05, 0.01) * T;
    const auto fit = fitBoardBundle(pointersTo(scene.views), start, firstParameters(truth.parameterCount()), 50);
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->converged);
    EXPECT_THAT(fit->estimate.camera.parameters(), IsNear(truth.parameters(), 1e-6));
    EXPECT_THAT(fit->estimate.T_camera_target[3], test::PoseIsNear(scene.T_camera_target[3], 1e-9));
  }
}

TEST(BoardBundle, ParametersThatAreNotFreeStay) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  const test::BoardScene scene = test::boardScene(truth, 4, rng);
  BoardBundle start{truth, scene.T_camera_target};
  start.camera.fx += 5.0;
  start.camera.cx += 3.0;
  const auto fit = fitBoardBundle(pointersTo(scene.views), start, {0, 1}, 50);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->estimate.camera.parameters().tail(7), start.camera.parameters().tail(7));
  EXPECT_EQ(fit->information.rows(), 2);
}

TEST(BoardBundle, APointOutsideTheCamerasDomainIsNoStart) {
  Rng rng = test::rngOfThisTest();
  const Camera truth = test::plumbBobCamera();
  test::BoardScene scene = test::boardScene(truth, 1, rng);
  scene.T_camera_target[0].translation().z() = -0.3;
  EXPECT_FALSE(fitBoardBundle(pointersTo(scene.views), {truth, scene.T_camera_target}, {}, 5));
  EXPECT_FALSE(boardResiduals(truth, scene.T_camera_target[0], scene.views[0]));
}

class BoardBundleStatistics : public testing::TestWithParam<Camera> {};

// The information is the inverse covariance: over seeds, e^T S e / sigma^2 of the estimate's error e follows chi-square with as many
// degrees of freedom as there are parameters.
TEST_P(BoardBundleStatistics, ErrorsAreAsLargeAsTheInformationSays) {
  constexpr int kSeeds = 20, kViews = 5;
  constexpr double kBound = 1e-4;  // probability that an honest program fails, either side; the seeds are fixed
  const Camera& truth = GetParam();
  // The information is that of the linearised problem: a rational lens, whose coefficients nearly cancel, is linear only closer by.
  const double sigma_px = truth.distortion.size() > 5 ? 1e-4 : 0.1;
  const int count = truth.parameterCount();
  Rng rng = test::rngOfThisTest();
  const test::BoardScene scene = test::boardScene(truth, kViews, rng);
  double sum = 0.0, squared_error = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const std::vector<BoardView> views = test::noisy(scene.views, sigma_px, rng);
    const auto fit = fitBoardBundle(pointersTo(views), {truth, scene.T_camera_target}, firstParameters(count), 30);
    ASSERT_TRUE(fit);
    const Eigen::VectorXd error = fit->estimate.camera.parameters() - truth.parameters();
    sum += error.dot(fit->information * error) / (sigma_px * sigma_px);
    squared_error += fit->squared_error / (sigma_px * sigma_px);
  }
  EXPECT_GT(sum, chiSquareQuantile(kBound, kSeeds * count));
  EXPECT_LT(sum, chiSquareQuantile(1.0 - kBound, kSeeds * count));
  const double freedoms = kSeeds * (2.0 * kViews * 35 - count - 6.0 * kViews);
  EXPECT_GT(squared_error, chiSquareQuantile(kBound, freedoms));
  EXPECT_LT(squared_error, chiSquareQuantile(1.0 - kBound, freedoms));
}

INSTANTIATE_TEST_SUITE_P(Models, BoardBundleStatistics, testing::ValuesIn(test::exampleCameras()),
                         [](const auto& parameter) { return std::string(distortionModelName(parameter.param.model)); });

TEST(BoardBundle, OpenDirectionsHaveNoCovariance) {
  Eigen::Matrix3d information;
  information << 4.0, 4.0, 0.0, 4.0, 4.0, 0.0, 0.0, 0.0, 25.0;  // only the sum of the first two is seen
  const Eigen::MatrixXd covariance = unitCovariance(information);
  EXPECT_TRUE(std::isnan(covariance(0, 0)));
  EXPECT_TRUE(std::isnan(covariance(1, 1)));
  EXPECT_NEAR(covariance(2, 2), 1.0 / 25.0, 1e-15);
}

}  // namespace
}  // namespace poecal
