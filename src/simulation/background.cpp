#include "simulation/background.hpp"

#include <opencv2/imgproc.hpp>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

constexpr double kPlainGrey = 110.0;
constexpr int kShapesOfEachKind = 12;

/// Light that falls off across the picture.
cv::Mat shading(int width, int height, Rng& rng) {
  const double middle = rng.uniform(90.0, 150.0);
  const double slope_x = rng.uniform(-50.0, 50.0) / width, slope_y = rng.uniform(-50.0, 50.0) / height;
  cv::Mat picture(height, width, CV_8U);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      picture.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(middle + slope_x * (u - width / 2) + slope_y * (v - height / 2));
    }
  }
  return picture;
}

cv::Point randomPoint(int width, int height, Rng& rng) {
  const int u = static_cast<int>(rng.below(static_cast<std::size_t>(width)));
  const int v = static_cast<int>(rng.below(static_cast<std::size_t>(height)));
  return {u, v};
}

cv::Scalar randomGrey(Rng& rng) { return cv::Scalar(rng.uniform(20.0, 235.0)); }

cv::Mat clutter(int width, int height, Rng& rng) {
  cv::Mat picture = shading(width, height, rng);
  // One draw a statement: the order in which a call's arguments are evaluated is the compiler's choice.
  for (int k = 0; k < kShapesOfEachKind; ++k) {
    const cv::Point corner = randomPoint(width, height, rng);
    const cv::Point size = randomPoint(width / 4, height / 4, rng);
    const cv::Scalar grey = randomGrey(rng);
    cv::rectangle(picture, corner, corner + size, grey, cv::FILLED);
  }
  for (int k = 0; k < kShapesOfEachKind; ++k) {
    const cv::Point start = randomPoint(width, height, rng);
    const cv::Point end = randomPoint(width, height, rng);
    const cv::Scalar grey = randomGrey(rng);
    const int thickness = 1 + static_cast<int>(rng.below(4));
    cv::line(picture, start, end, grey, thickness, cv::LINE_AA);
  }
  for (int k = 0; k < kShapesOfEachKind; ++k) {
    const cv::Point center = randomPoint(width, height, rng);
    const cv::Point axes = randomPoint(40, 40, rng);
    const double angle_deg = rng.uniform(0.0, 180.0);
    const cv::Scalar grey = randomGrey(rng);
    cv::ellipse(picture, center, cv::Size(2 + axes.x, 2 + axes.y), angle_deg, 0.0, 360.0, grey, cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

}  // namespace

cv::Mat drawBackground(const std::string& name, int width, int height, Rng& rng) {
  cv::Mat background(height, width, CV_32F, cv::Scalar(kPlainGrey));
  if (name == "clutter") {
    clutter(width, height, rng).convertTo(background, CV_32F);
  } else if (name != "plain") {
    throw InvalidArgument("background '" + name + "' is not known, expected clutter or plain");
  }
  return background;
}

}  // namespace poecal
