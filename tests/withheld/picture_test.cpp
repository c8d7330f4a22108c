// Do pictures show the tag where the corners are?
#include <filesystem>
#include <memory>

#include <apriltag/apriltag.h>
#include <apriltag/common/image_u8.h>
#include <apriltag/tag36h11.h>
#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "withheld/case.hpp"
#include "withheld/setting.hpp"

namespace withheld {
namespace {

/// Corners of the one tag in a picture by AprilTag's own detector, in its order. Its first pixel's centre is at (0.5, 0.5).
Eigen::VectorXd found(const std::filesystem::path& file) {
  cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  image_u8_t image = {picture.cols, picture.rows, picture.cols, picture.data};
  const std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)> family(tag36h11_create(), &tag36h11_destroy);
  const std::unique_ptr<apriltag_detector_t, decltype(&apriltag_detector_destroy)> detector(apriltag_detector_create(),
                                                                                            &apriltag_detector_destroy);
  apriltag_detector_add_family(detector.get(), family.get());
  detector->quad_decimate = 1.0F;
  const std::unique_ptr<zarray_t, decltype(&apriltag_detections_destroy)> tags(apriltag_detector_detect(detector.get(), &image),
                                                                               &apriltag_detections_destroy);
  if (zarray_size(tags.get()) != 1) throw std::runtime_error("not one tag in " + file.string());
  apriltag_detection_t* tag = nullptr;
  zarray_get(tags.get(), 0, &tag);
  Eigen::VectorXd pixels(8);
  for (int i = 0; i < 4; ++i) pixels.segment<2>(2 * i) << tag->p[i][0] - 0.5, tag->p[i][1] - 0.5;
  return pixels;
}

TEST(Pictures, ShowTheTagWhereItsCornersAre) {
  Case made;
  Chance chance(11);
  Wishes wishes;
  wishes.pictures = true;
  drawSetting(made, wishes, chance);
  Lens& lens = made.actual.lens;
  lens.k1 = lens.k2 = lens.p1 = lens.p2 = 0.0;  // AprilTag fits straight edges
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "withheld-picture-test.png";
  constexpr int kPictures = 8;
  double squares = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int i = 0; i < kPictures; ++i) {
    const Shot& shot = made.shots[static_cast<std::size_t>(i)];
    drawPicture(made.actual, shot, {}, {30.0, 215.0, 0.7, 1.0, 3}, file);
    const Eigen::VectorXd off = found(file) - corners(made.actual, shot, {});
    for (int c = 0; c < 4; ++c) mean += off.segment<2>(2 * c) / (4.0 * kPictures);
    squares += off.squaredNorm() / (8.0 * kPictures);
  }
  std::filesystem::remove(file);
  // The detector's own errors are 0.04 to 0.06 px a coordinate, with a sign that hangs on the edge's direction.
  EXPECT_LT(std::sqrt(squares), 0.08);
  EXPECT_LT(mean.norm(), 0.03);
}

TEST(Lens, FindsTheRayOfEveryPixel) {
  Lens lens;
  lens.k1 = -0.15;
  lens.k2 = 0.05;
  lens.p1 = 1e-3;
  lens.p2 = -5e-4;
  for (const double u : {0.0, 700.0, 1400.0, 2447.0}) {
    for (const double v : {0.0, 1023.5, 2047.0}) {
      const Eigen::Vector2d ray = lens.ray({u, v});
      EXPECT_LT((lens.image(Vector(ray.x(), ray.y(), 1.0)) - Eigen::Vector2d(u, v)).norm(), 1e-8);  // 1e-12 of 2400 px, and rounding
    }
  }
}

}  // namespace
}  // namespace withheld
