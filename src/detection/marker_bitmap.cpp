#include "detection/marker_bitmap.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include "detection/tag_family.hpp"
#include "poecal/core/error.hpp"
#include "target/names.hpp"

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

/// More rings of black cells between the border of one cell, which starts inside the outermost ring, and what is within.
MarkerBitmap withWiderBorder(const MarkerBitmap& narrow, int more) {
  MarkerBitmap wide{.width = narrow.width + 2 * more, .corner_width = narrow.corner_width + 2 * more, .white = {}};
  const int outermost = (narrow.width - narrow.corner_width) / 2;
  for (int row = 0; row < wide.width; ++row) {
    for (int column = 0; column < wide.width; ++column) {
      const int ring = std::min({row, column, wide.width - 1 - row, wide.width - 1 - column});
      const bool drawn = ring >= outermost + more;
      wide.white.push_back(drawn ? narrow.isWhite(column - more, row - more) : ring < outermost);
    }
  }
  return wide;
}

}  // namespace

MarkerBitmap tagBitmap(const std::string& name, int id, int border_bits) {
  const TagFamily family = makeTagFamily(name);
  if (id < 0 || static_cast<std::uint32_t>(id) >= family->ncodes) {
    throw InvalidArgument(fmt::format("tag id {} does not exist, {} has ids 0 to {}", id, name, family->ncodes - 1));
  }
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(apriltag_to_image(family.get(), id), freeImage);
  MarkerBitmap bitmap{.width = image->width, .corner_width = family->width_at_border, .white = {}};
  for (int row = 0; row < image->height; ++row) {
    for (int column = 0; column < image->width; ++column) bitmap.white.push_back(image->buf[row * image->stride + column] > 127);
  }
  if (border_bits == 1) return bitmap;
  if (border_bits < 1 || !mayHaveWideBorder(name)) {
    throw InvalidArgument(fmt::format("a tag of {} with a border of {} cells is not known", name, border_bits));
  }
  return withWiderBorder(bitmap, border_bits - 1);
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
