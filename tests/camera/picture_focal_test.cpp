// Pictures of a lens that was zoomed or focused anew among others.
#include <cmath>

#include <gmock/gmock.h>

#include "camera/camera_examples.hpp"
#include "camera/synthetic_boards.hpp"
#include "poecal/camera/intrinsics.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

constexpr int kPictures = 12;

/// Boards before a camera, the pictures from `first` on with `factor` times its focal length; corners with 0.1 px of noise.
std::vector<BoardView> zoomedFrom(std::size_t first, double factor, const Camera& truth) {
  Rng rng = test::rngOfThisTest();
  test::BoardScene scene = test::boardScene(truth, kPictures, rng);
  Camera zoomed = truth;
  zoomed.fx *= factor;
  zoomed.fy *= factor;
  for (std::size_t v = first; v < scene.views.size(); ++v) {
    BoardView& view = scene.views[v];
    for (Eigen::Index j = 0; j < view.points.cols(); ++j) {
      view.pixels.col(j) = *project(zoomed, scene.T_camera_target[v] * view.points.col(j));
    }
  }
  return test::noisy(scene.views, 0.1, rng);
}

IntrinsicsResult calibrated(const std::vector<BoardView>& views, const Camera& truth) {
  IntrinsicsOptions options;
  options.model = truth.model;
  return calibrateIntrinsics(views, truth.width, truth.height, options);
}

TEST(PictureFocal, OfOneLensIsOne) {
  for (const Camera& truth : {test::plumbBobCamera(), test::equidistantCamera(), test::rationalCamera()}) {
    EXPECT_THAT(calibrated(zoomedFrom(kPictures, 1.0, truth), truth).warnings, Not(Contains(HasSubstr("focal length"))));
  }
}

TEST(PictureFocal, OfOnePictureThatIsZoomedIsNamed) {
  const Camera truth = test::plumbBobCamera();
  EXPECT_THAT(
      calibrated(zoomedFrom(kPictures - 1, 1.1, truth), truth).warnings,
      Contains(HasSubstr("1 of 12 pictures looks taken with another focal length (1.1 times that of the others in the median: view-11)")));
}

TEST(PictureFocal, OfManyPicturesThatAreZoomedIsAnError) {
  const Camera truth = test::plumbBobCamera();
  EXPECT_THAT([&] { calibrated(zoomedFrom(kPictures / 2, 1.2, truth), truth); },
              ThrowsMessage<ImplausibleInput>(HasSubstr("pictures look taken with another focal length")));
}

// Bowed by 4 mm over its width of 0.21 m it leaves 0.8 px, and the pictures still agree on one focal length.
TEST(PictureFocal, OfABentBoardIsNoMistakeOfTheLens) {
  const Camera truth = test::plumbBobCamera();
  constexpr double kBow = 4e-3;
  Rng rng = test::rngOfThisTest();
  test::BoardScene scene = test::boardScene(truth, kPictures, rng);
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    BoardView& view = scene.views[v];
    const double first = view.points.row(0).minCoeff(), width = view.points.row(0).maxCoeff() - first;
    for (Eigen::Index j = 0; j < view.points.cols(); ++j) {
      Eigen::Vector3d p = view.points.col(j);
      p.z() += kBow * (1.0 - std::pow(2.0 * (p.x() - first) / width - 1.0, 2));
      view.pixels.col(j) = *project(truth, scene.T_camera_target[v] * p);
    }
  }
  const IntrinsicsResult result = calibrated(test::noisy(scene.views, 0.1, rng), truth);
  EXPECT_GT(result.chosen().rms_px, 0.5) << "or the test proves nothing";
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("focal length"))));
}

}  // namespace
}  // namespace poecal
