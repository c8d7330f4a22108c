#include "detection/subpixel.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace poecal {

void refineSaddles(const cv::Mat& grey, std::vector<cv::Point2f>& corners, double clearance) {
  const int half = std::clamp(static_cast<int>(std::floor(clearance)), 2, 11);
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-4);
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1}, until);
}

}  // namespace poecal
