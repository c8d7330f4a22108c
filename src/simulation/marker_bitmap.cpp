#include "simulation/marker_bitmap.hpp"

#include <memory>

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include "poecal/core/error.hpp"
#include "target/names.hpp"

namespace poecal {
namespace {

struct FamilyMaker {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr FamilyMaker kFamilyMakers[] = {
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
};

using FamilyPointer = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

FamilyPointer makeFamily(const std::string& name) {
  for (const FamilyMaker& maker : kFamilyMakers) {
    if (maker.name == name) return {maker.create(), maker.destroy};
  }
  throw InvalidArgument(fmt::format("tag family '{}' cannot be drawn", name));
}

/// OpenCV numbers its dictionaries in the order of markerDictionaries(), from DICT_4X4_50 = 0.
cv::Ptr<cv::aruco::Dictionary> makeDictionary(const std::string& name) {
  const IdSet& set = findIdSet(markerDictionaries(), name, "dictionary");
  return cv::aruco::getPredefinedDictionary(static_cast<int>(&set - markerDictionaries().data()));
}

}  // namespace

MarkerBitmap tagBitmap(const std::string& name, int id) {
  const FamilyPointer family = makeFamily(name);
  if (id < 0 || static_cast<std::uint32_t>(id) >= family->ncodes) {
    throw InvalidArgument(fmt::format("tag id {} does not exist, {} has ids 0 to {}", id, name, family->ncodes - 1));
  }
  const std::unique_ptr<image_u8_t, decltype(&image_u8_destroy)> image(apriltag_to_image(family.get(), static_cast<std::uint32_t>(id)),
                                                                       image_u8_destroy);
  MarkerBitmap bitmap{.width = image->width, .corner_width = family->width_at_border, .white = {}};
  for (int row = 0; row < image->height; ++row) {
    for (int column = 0; column < image->width; ++column) bitmap.white.push_back(image->buf[row * image->stride + column] > 127);
  }
  return bitmap;
}

MarkerBitmap arucoBitmap(const std::string& name, int id) {
  const cv::Ptr<cv::aruco::Dictionary> dictionary = makeDictionary(name);
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
