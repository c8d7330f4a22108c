#include <algorithm>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "detection/board_saddles.hpp"
#include "detection/corner_finder.hpp"
#include "detection/subpixel.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

class ChessboardFinder : public CornerFinder {
 public:
  ChessboardFinder(const Target& target, bool refine) : size_(target.cols, target.rows), refine_(refine) {}

  FoundCorners find(const cv::Mat& grey) override {
    std::vector<cv::Point2f> corners = search(grey);
    if (corners.empty()) return {{}, {whyNot(grey)}};
    // Half a typical side keeps most of each window clear of the next corner, and the customary 11 px wherever squares allow it.
    refineSaddles(grey, corners, 0.5 * typicalSide(corners));
    bool first_is_dark = firstSquareIsDark(grey, corners);
    if (colourTellsEnds() && !first_is_dark) {
      std::reverse(corners.begin(), corners.end());
      first_is_dark = true;
    }
    std::vector<BoardSaddle> saddles;
    for (int k = 0; k < static_cast<int>(corners.size()); ++k) {
      const cv::Point2d px = corners[static_cast<std::size_t>(k)];
      saddles.push_back({k % size_.width, k / size_.width, {px.x, px.y}});
    }
    if (refine_) fitBoardSaddles(grey, cells_, first_is_dark ? DarkPair::kMain : DarkPair::kOther, saddles);
    FoundCorners finding;
    for (int k = 0; k < static_cast<int>(saddles.size()); ++k) {
      finding.corners.push_back({{-1, k}, saddles[static_cast<std::size_t>(k)].px, saddles[static_cast<std::size_t>(k)].sigma});
    }
    return finding;
  }

 private:
  /// Corners about right, in OpenCV's order; empty where there is no such board.
  std::vector<cv::Point2f> search(const cv::Mat& grey) const {
    std::vector<cv::Point2f> corners;
    if (cv::findChessboardCorners(grey, size_, corners, kGlobalThreshold)) return corners;
    // Local thresholds cut even paper into thousands of pieces where there is noise, and take minutes over them: in a smaller and smoother
    // picture they do not.
    const double rough = reductionTo(kRoughSide, grey), medium = reductionTo(kMediumSide, grey);
    cv::Mat smooth;
    cv::GaussianBlur(reduced(grey, rough), smooth, {}, 1.0);
    if (cv::findChessboardCorners(smooth, size_, corners, kGlobalThreshold | cv::CALIB_CB_ADAPTIVE_THRESH)) {
      return enlarged(corners, rough);
    }
    if (cv::findChessboardCornersSB(reduced(grey, medium), size_, corners)) return enlarged(corners, medium);
    return {};
  }

  /// What to say of a picture in which the board was not found: which other one is there.
  std::string whyNot(const cv::Mat& grey) const {
    std::string message = fmt::format("no chessboard of {} x {} inner corners was found", size_.width, size_.height);
    const cv::Mat medium = reduced(grey, reductionTo(kMediumSide, grey));
    std::vector<cv::Point2f> corners;
    cv::Mat meta;
    if (!cv::findChessboardCornersSB(medium, cv::Size(3, 3), corners, cv::CALIB_CB_LARGER, meta)) return message;
    cv::Size seen = meta.size();
    // The board lies as it likes; it is said the way round that is stated.
    if ((seen.width < seen.height) != (size_.width < size_.height)) std::swap(seen.width, seen.height);
    // What grows square by square may stop at a shadow: two methods must agree on a number.
    if (seen == size_ || !cv::findChessboardCorners(medium, seen, corners, kGlobalThreshold)) return message;
    message += fmt::format("; one of {} x {} was", seen.width, seen.height);
    if (seen == size_ - cv::Size(1, 1)) message += ": cols and rows count inner corners";
    return message;
  }

  /// How many pixels of the picture one of a picture whose longer side has at most `side` pixels is wide.
  static double reductionTo(int side, const cv::Mat& grey) {
    return std::max(1.0, static_cast<double>(std::max(grey.cols, grey.rows)) / side);
  }

  static cv::Mat reduced(const cv::Mat& grey, double scale) {
    if (scale == 1.0) return grey;
    cv::Mat small;
    cv::resize(grey, small, {}, 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
    return small;
  }

  static std::vector<cv::Point2f> enlarged(std::vector<cv::Point2f> corners, double scale) {
    // Centre of the small pixel u is the large (u + 0.5) scale - 0.5.
    for (cv::Point2f& px : corners) px = cv::Point2f(cv::Point2d(px) * scale + cv::Point2d(0.5, 0.5) * (scale - 1.0));
    return corners;
  }

  static constexpr int kGlobalThreshold = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  static constexpr int kRoughSide = 640, kMediumSide = 1280;  // [px]

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
  bool refine_;
  SaddleCells cells_ = SaddleCells::chessboard();
};

}  // namespace

std::unique_ptr<CornerFinder> makeChessboardFinder(const Target& target, bool refine) {
  return std::make_unique<ChessboardFinder>(target, refine);
}

}  // namespace poecal
