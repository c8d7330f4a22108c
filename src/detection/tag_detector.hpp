// libapriltag behind a C++ face: all tags of one family in a picture, with corners in OpenCV's pixels.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace poecal {

struct TagDetection {
  int id = 0;
  int corrected_bits = 0;
  double decision_margin = 0.0;  ///< mean distance of the bits' grey values from the threshold between black and white
  Eigen::Matrix<double, 2, 4> px = Eigen::Matrix<double, 2, 4>::Zero();  ///< column k: corner k in the contract's order

  Eigen::Vector2d centre() const { return px.rowwise().mean(); }
  double longestSide() const;
};

class TagDetector {
 public:
  /// @throws InvalidArgument for an unknown family.
  explicit TagDetector(const std::string& family);
  TagDetector(const std::string& family, int corrected_bits);
  ~TagDetector();
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  int idCount() const;
  /// One pass. @param grey  8-bit, one channel. @param quad_decimate  as in DetectOptions.
  std::vector<TagDetection> detect(const cv::Mat& grey, double quad_decimate, bool refine_edges);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

/// All tags that the full picture gives: found with and without refined edges, each once.
///
/// Refining loses some small tags and throws corners of others off by pixels. A tag that both passes find has its refined corners if
/// none moved by more than 1 px, otherwise the unrefined ones; a tag that one pass finds has that pass's.
std::vector<TagDetection> detectThoroughly(TagDetector& detector, const cv::Mat& grey);

/// Adds those of `more` that are not in `tags` yet (same id, centres nearer than half a side).
void addUnseen(std::vector<TagDetection>& tags, const std::vector<TagDetection>& more);

}  // namespace poecal
