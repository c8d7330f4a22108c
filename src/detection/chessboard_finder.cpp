#include <algorithm>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "detection/corner_finder.hpp"
#include "detection/subpixel.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

class ChessboardFinder : public CornerFinder {
 public:
  explicit ChessboardFinder(const Target& target) : size_(target.cols, target.rows) {}

  FoundCorners find(const cv::Mat& grey) override {
    std::vector<cv::Point2f> corners;
    constexpr int kFlags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
    if (!cv::findChessboardCorners(grey, size_, corners, kFlags)) {
      return {{}, {fmt::format("no chessboard of {} x {} inner corners was found", size_.width, size_.height)}};
    }
    // Half a typical side keeps most of each window clear of the next corner, and the customary 11 px wherever squares allow it.
    refineSaddles(grey, corners, 0.5 * typicalSide(corners));
    if (colourTellsEnds() && !firstSquareIsDark(grey, corners)) std::reverse(corners.begin(), corners.end());
    FoundCorners finding;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      finding.corners.push_back({{-1, static_cast<int>(k)}, {static_cast<double>(corners[k].x), static_cast<double>(corners[k].y)}});
    }
    return finding;
  }

 private:
  const cv::Point2f& at(const std::vector<cv::Point2f>& corners, int col, int row) const {
    return corners[static_cast<std::size_t>(row * size_.width + col)];
  }

  /// Median side of the squares [px].
  double typicalSide(const std::vector<cv::Point2f>& corners) const {
    std::vector<double> sides;
    for (int row = 0; row < size_.height; ++row) {
      for (int col = 0; col < size_.width; ++col) {
        if (col > 0) sides.push_back(cv::norm(at(corners, col, row) - at(corners, col - 1, row)));
        if (row > 0) sides.push_back(cv::norm(at(corners, col, row) - at(corners, col, row - 1)));
      }
    }
    return median(std::move(sides));
  }

  /// With an odd and an even number of corners half a turn of the board swaps black and white.
  bool colourTellsEnds() const { return (size_.width + size_.height) % 2 == 1; }

  /// Whether the square between corners 0, 1, cols and cols + 1 is darker than the one beside it along the row.
  bool firstSquareIsDark(const cv::Mat& grey, const std::vector<cv::Point2f>& corners) const {
    const auto brightness = [&](int col) {
      const cv::Point2f centre = 0.25F * (at(corners, col, 0) + at(corners, col + 1, 0) + at(corners, col, 1) + at(corners, col + 1, 1));
      cv::Mat patch;
      cv::getRectSubPix(grey, {3, 3}, centre, patch);
      return cv::mean(patch)[0];
    };
    return brightness(0) < brightness(1);
  }

  cv::Size size_;
};

}  // namespace

std::unique_ptr<CornerFinder> makeChessboardFinder(const Target& target) { return std::make_unique<ChessboardFinder>(target); }

}  // namespace poecal
