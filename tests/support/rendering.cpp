#include "support/rendering.hpp"

#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagStandard41h12.h>
}

namespace poecal::test {
namespace {

constexpr int kSupersample = 8;

cv::Matx33d homography(const Quad& from, const Quad& to) {
  std::vector<cv::Point2f> a, b;
  for (int k = 0; k < 4; ++k) {
    a.emplace_back(static_cast<float>(from(0, k)), static_cast<float>(from(1, k)));
    b.emplace_back(static_cast<float>(to(0, k)), static_cast<float>(to(1, k)));
  }
  return cv::getPerspectiveTransform(a, b);
}

}  // namespace

void drawTexture(cv::Mat& picture, const cv::Mat& texture, const Quad& texture_quad, const Quad& picture_quad) {
  // Centre of the fine pixel U is the coarse (U + 0.5) / 8 - 0.5.
  const cv::Matx33d to_fine(kSupersample, 0, 0.5 * (kSupersample - 1), 0, kSupersample, 0.5 * (kSupersample - 1), 0, 0, 1);
  cv::Mat fine;
  cv::resize(picture, fine, {}, kSupersample, kSupersample, cv::INTER_NEAREST);
  cv::warpPerspective(texture, fine, to_fine * homography(texture_quad, picture_quad), fine.size(), cv::INTER_NEAREST,
                      cv::BORDER_TRANSPARENT);
  cv::resize(fine, picture, picture.size(), 0, 0, cv::INTER_AREA);
}

Eigen::Matrix2Xd mapPoints(const Eigen::Matrix2Xd& points, const Quad& texture_quad, const Quad& picture_quad) {
  const cv::Matx33d H = homography(texture_quad, picture_quad);
  Eigen::Matrix2Xd mapped(2, points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const cv::Vec3d p = H * cv::Vec3d(points(0, k), points(1, k), 1.0);
    mapped.col(k) << p[0] / p[2], p[1] / p[2];
  }
  return mapped;
}

TagTexture tagTexture(const std::string& family, int id) {
  apriltag_family_t* codes = family == "tag25h9"            ? tag25h9_create()
                             : family == "tagStandard41h12" ? tagStandard41h12_create()
                                                            : tag36h11_create();
  image_u8_t* image = apriltag_to_image(codes, static_cast<uint32_t>(id));
  TagTexture tag;
  tag.texture = cv::Mat(image->height, image->width, CV_8UC1, image->buf, static_cast<std::size_t>(image->stride)).clone();
  const double low = 0.5 * (codes->total_width - codes->width_at_border) - 0.5;
  const double high = low + codes->width_at_border;
  tag.corners << low, high, high, low,  //
      high, high, low, low;
  // Debian's library does not export image_u8_destroy, which does these two.
  std::free(image->buf);
  std::free(image);
  if (family == "tag25h9") {
    tag25h9_destroy(codes);
  } else if (family == "tagStandard41h12") {
    tagStandard41h12_destroy(codes);
  } else {
    tag36h11_destroy(codes);
  }
  return tag;
}

cv::Mat tagPicture(const std::string& family, int id, const Quad& corners, cv::Size size) {
  const TagTexture tag = tagTexture(family, id);
  cv::Mat picture(size, CV_8UC1, cv::Scalar(255));
  drawTexture(picture, tag.texture, tag.corners, corners);
  return picture;
}

Quad tiltedSquare(const Eigen::Vector2d& centre, double side, double angle, double tilt) {
  constexpr double kDistance = 6.0;  // of the camera, in sides
  Quad quad;
  const double unit[2][4] = {{-0.5, 0.5, 0.5, -0.5}, {0.5, 0.5, -0.5, -0.5}};
  for (int k = 0; k < 4; ++k) {
    const double x = unit[0][k];
    const double y = unit[1][k] * std::cos(tilt);
    const double scale = kDistance / (kDistance + unit[1][k] * std::sin(tilt));
    quad.col(k) =
        centre + side * scale * Eigen::Vector2d(std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y);
  }
  return quad;
}

void degrade(cv::Mat& picture, Rng& rng, double blur, double noise) {
  cv::Mat values;
  picture.convertTo(values, CV_32F, 0.7, 30.0);
  cv::GaussianBlur(values, values, {}, blur);
  if (noise > 0.0) {
    for (int row = 0; row < values.rows; ++row) {
      for (int col = 0; col < values.cols; ++col) values.at<float>(row, col) += static_cast<float>(noise * rng.normal());
    }
  }
  values.convertTo(picture, CV_8U);
}

Eigen::Vector2d CornerErrors::mean() const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& error : errors) sum += error;
  return sum / static_cast<double>(errors.size());
}

double CornerErrors::rmsAboutMean() const {
  const Eigen::Vector2d centre = mean();
  double sum = 0.0;
  for (const Eigen::Vector2d& error : errors) sum += (error - centre).squaredNorm();
  return std::sqrt(sum / (2.0 * static_cast<double>(errors.size())));
}

double CornerErrors::largest() const {
  double largest = 0.0;
  for (const Eigen::Vector2d& error : errors) largest = std::max(largest, error.norm());
  return largest;
}

}  // namespace poecal::test
