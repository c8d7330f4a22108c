#include "detection/marker_bitmap.hpp"

#include <cstdint>
#include <cstdlib>
#include <memory>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include "detection/tag_family.hpp"
#include "poecal/core/error.hpp"

extern "C" {
#include <apriltag/apriltag.h>
}

namespace poecal {
namespace {

/// The library's own image_u8_destroy, which Debian's package does not export.
void freeImage(image_u8_t* image) {
  std::free(image->buf);
  std::free(image);
}

}  // namespace

MarkerBitmap tagBitmap(const std::string& name, int id) {
  const TagFamily family = makeTagFamily(name);
  if (id < 0 || static_cast<std::uint32_t>(id) >= family->ncodes) {
    throw InvalidArgument(fmt::format("tag id {} does not exist, {} has ids 0 to {}", id, name, family->ncodes - 1));
  }
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(apriltag_to_image(family.get(), id), freeImage);
  MarkerBitmap bitmap{.width = image->width, .corner_width = family->width_at_border, .white = {}};
  for (int row = 0; row < image->height; ++row) {
    for (int column = 0; column < image->width; ++column) bitmap.white.push_back(image->buf[row * image->stride + column] > 127);
  }
  return bitmap;
}

MarkerBitmap arucoBitmap(const std::string& name, int id) {
  const cv::Ptr<cv::aruco::Dictionary> dictionary = makeMarkerDictionary(name);
  if (id < 0 || id >= dictionary->bytesList.rows) {
    throw InvalidArgument(fmt::format("marker id {} does not exist, {} has ids 0 to {}", id, name, dictionary->bytesList.rows - 1));
  }
  constexpr int kBorderCells = 1;
  const int width = dictionary->markerSize + 2 * kBorderCells;
  cv::Mat image;
  cv::aruco::drawMarker(dictionary, id, width, image, kBorderCells);
  MarkerBitmap bitmap{.width = width, .corner_width = width, .white = {}};
  for (int row = 0; row < width; ++row) {
    for (int column = 0; column < width; ++column) bitmap.white.push_back(image.at<std::uint8_t>(row, column) > 127);
  }
  return bitmap;
}

}  // namespace poecal
