// Pictures of a lens that was zoomed or focused anew among others.
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

}  // namespace
}  // namespace poecal
