// Tags whose black border is two cells wide, as Kalibr draws them: libapriltag reads them not, OpenCV's aruco does.
#pragma once

#include <string>
#include <vector>

#include <opencv2/aruco.hpp>

#include "detection/tag_detector.hpp"

namespace poecal {

class WideTagDetector {
 public:
  /// @param family  one that mayHaveWideBorder(). @throws InvalidArgument for an unknown one.
  explicit WideTagDetector(const std::string& family);

  /// All tags of the family in a picture, their corners (outer ones of the black border) to about a pixel, in libapriltag's order.
  std::vector<TagDetection> detect(const cv::Mat& grey);

 private:
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
  int quarter_turns_ = 0;  ///< clockwise, from libapriltag's upright tag to OpenCV's
};

}  // namespace poecal
