// What finds the corners of one kind of target in one picture.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "poecal/capture/detections.hpp"
#include "poecal/detection/detector.hpp"

namespace poecal {

/// Corners of one picture, sorted by id, and what there is to say about it.
struct FoundCorners {
  std::vector<Corner> corners;
  std::vector<std::string> notes;                  ///< one sentence each; there is one where `corners` is empty
  std::optional<PictureLook> look = std::nullopt;  ///< where a tag was fitted to the picture
};

/// Holds whatever can be reused from picture to picture. One object serves one thread at a time.
class CornerFinder {
 public:
  virtual ~CornerFinder() = default;
  /// @param grey  8-bit, one channel.
  virtual FoundCorners find(const cv::Mat& grey) = 0;
};

std::unique_ptr<CornerFinder> makeAprilTagFinder(const Target& target, const DetectOptions& options);
std::unique_ptr<CornerFinder> makeCharucoFinder(const Target& target, bool refine = true);
std::unique_ptr<CornerFinder> makeChessboardFinder(const Target& target, bool refine = true);

}  // namespace poecal
