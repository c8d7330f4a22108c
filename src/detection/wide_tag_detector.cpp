#include "detection/wide_tag_detector.hpp"

#include <cassert>

#include "detection/marker_bitmap.hpp"
#include "detection/tag_family.hpp"

namespace poecal {
namespace {

constexpr int kBorderBits = 2;

/// OpenCV's name of a family: "tag36h11" is DICT_APRILTAG_36h11.
std::string dictionaryOf(const std::string& family) { return "DICT_APRILTAG_" + family.substr(3); }

bool isTurned(const MarkerBitmap& upright, const MarkerBitmap& turned, int quarter_turns) {
  const int inside = turned.width;
  const int margin = (upright.width - inside) / 2;
  for (int row = 0; row < inside; ++row) {
    for (int column = 0; column < inside; ++column) {
      int x = column, y = row;
      for (int turn = 0; turn < quarter_turns; ++turn) {
        const int before = x;
        x = y;
        y = inside - 1 - before;
      }
      if (turned.isWhite(column, row) != upright.isWhite(margin + x, margin + y)) return false;
    }
  }
  return true;
}

/// The two libraries do not hold the same side of a tag to be its upper one.
int quarterTurns(const std::string& family) {
  const MarkerBitmap upright = tagBitmap(family, 0), turned = arucoBitmap(dictionaryOf(family), 0);
  for (int turns = 0; turns < 4; ++turns) {
    if (isTurned(upright, turned, turns)) return turns;
  }
  assert(false && "the families of both libraries have the same codes");
  return 0;
}

}  // namespace

WideTagDetector::WideTagDetector(const std::string& family)
    : dictionary_(makeMarkerDictionary(dictionaryOf(family))),
      parameters_(cv::aruco::DetectorParameters::create()),
      quarter_turns_(quarterTurns(family)) {
  parameters_->markerBorderBits = kBorderBits;
  // Windows that stay inside of a border of two cells; where squares touch the corners, these are saddles.
  parameters_->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  parameters_->cornerRefinementWinSize = 3;
}

std::vector<TagDetection> WideTagDetector::detect(const cv::Mat& grey) {
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, dictionary_, markers, ids, parameters_);
  std::vector<TagDetection> tags;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    TagDetection& tag = tags.emplace_back();
    tag.id = ids[k];
    // Both clockwise from the upper left: OpenCV's corner i is the upright tag's i - turns. libapriltag counts the other way, from below.
    for (int corner = 0; corner < 4; ++corner) {
      const cv::Point2f& px = markers[k][static_cast<std::size_t>((3 - corner + quarter_turns_) % 4)];
      tag.px.col(corner) << static_cast<double>(px.x), static_cast<double>(px.y);
    }
  }
  return tags;
}

}  // namespace poecal
