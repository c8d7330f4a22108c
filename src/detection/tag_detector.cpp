#include "detection/tag_detector.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>

#include "detection/memory.hpp"
#include "detection/tag_family.hpp"

extern "C" {
#include <apriltag/apriltag.h>
}

namespace poecal {
namespace {

TagDetection convert(const apriltag_detection_t& raw) {
  TagDetection tag;
  tag.id = raw.id;
  tag.corrected_bits = raw.hamming;
  tag.decision_margin = static_cast<double>(raw.decision_margin);
  // The library counts from the corner of the top-left pixel, OpenCV from its centre.
  for (int corner = 0; corner < 4; ++corner) tag.px.col(corner) << raw.p[corner][0] - 0.5, raw.p[corner][1] - 0.5;
  return tag;
}

double largestMove(const TagDetection& a, const TagDetection& b) { return (a.px - b.px).colwise().norm().maxCoeff<Eigen::PropagateNaN>(); }

bool sameTag(const TagDetection& a, const TagDetection& b) {
  return a.id == b.id && (a.centre() - b.centre()).norm() < 0.5 * std::max(a.longestSide(), b.longestSide());
}

}  // namespace

double TagDetection::longestSide() const {
  double longest = 0.0;
  for (int corner = 0; corner < 4; ++corner) longest = std::max(longest, (px.col((corner + 1) % 4) - px.col(corner)).norm());
  return longest;
}

struct TagDetector::Library {
  TagFamily family;
  apriltag_detector_t* detector;

  Library(const std::string& name, int corrected_bits) : family(makeTagFamily(name)), detector(apriltag_detector_create()) {
    const MemoryWatch watch;
    apriltag_detector_add_family_bits(detector, family.get(), corrected_bits);
    // Without its table of codes the library finds no tag in any picture.
    if (family->impl == nullptr) throw std::bad_alloc();
    watch.check();
    detector->nthreads = 1;  // pictures run in parallel already
  }
  ~Library() { apriltag_detector_destroy(detector); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

TagDetector::TagDetector(const std::string& family) : TagDetector(family, correctableBits(family)) {}

TagDetector::TagDetector(const std::string& family, int corrected_bits) : library_(std::make_unique<Library>(family, corrected_bits)) {}

TagDetector::~TagDetector() = default;

int TagDetector::idCount() const { return static_cast<int>(library_->family->ncodes); }

std::vector<TagDetection> TagDetector::detect(const cv::Mat& grey, double quad_decimate, bool refine_edges) {
  // Below a few pixels a side the library reads outside of its picture; no tag of 5 or more bits a side is readable below 8 either.
  constexpr double kSmallestSide = 8.0;
  if (std::min(grey.cols, grey.rows) < kSmallestSide * quad_decimate) return {};
  library_->detector->quad_decimate = static_cast<float>(quad_decimate);
  library_->detector->refine_edges = refine_edges;
  // The library does not look whether it was given the memory that it asks for.
  requireMemory(searchMemory(static_cast<std::int64_t>(grey.total())));
  const MemoryWatch watch;
  image_u8_t view{grey.cols, grey.rows, static_cast<int32_t>(grey.step[0]), grey.data};
  zarray_t* found = apriltag_detector_detect(library_->detector, &view);
  std::vector<TagDetection> tags;
  for (int k = 0; k < zarray_size(found); ++k) {
    apriltag_detection_t* raw = nullptr;
    zarray_get(found, k, static_cast<void*>(&raw));
    tags.push_back(convert(*raw));
  }
  apriltag_detections_destroy(found);
  watch.check();
  return tags;
}

void addUnseen(std::vector<TagDetection>& tags, const std::vector<TagDetection>& more) {
  for (const TagDetection& candidate : more) {
    if (std::none_of(tags.begin(), tags.end(), [&](const TagDetection& tag) { return sameTag(tag, candidate); })) tags.push_back(candidate);
  }
}

std::vector<TagDetection> detectThoroughly(TagDetector& detector, const cv::Mat& grey) {
  constexpr double kPlausibleMove = 1.0;  // [px]; on readable tags refinement moves corners by 0.1 to 0.5
  std::vector<TagDetection> tags = detector.detect(grey, 1.0, false);
  const std::vector<TagDetection> refined = detector.detect(grey, 1.0, true);
  for (TagDetection& tag : tags) {
    const auto better = std::find_if(refined.begin(), refined.end(), [&](const TagDetection& candidate) {
      return candidate.id == tag.id && largestMove(candidate, tag) <= kPlausibleMove;
    });
    if (better != refined.end()) tag = *better;
  }
  addUnseen(tags, refined);
  return tags;
}

}  // namespace poecal
