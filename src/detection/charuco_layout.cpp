#include "detection/charuco_layout.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>

#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// Centre of a marker's square on OpenCV 4.6's board of `cols` squares a row, where the top-left square is black [squares].
cv::Point2d centreOf(int id, int cols) {
  int row = 0, first = 0;
  const auto inRow = [cols](int r) { return r % 2 == 0 ? cols / 2 : (cols + 1) / 2; };
  while (first + inRow(row) <= id) first += inRow(row++);
  return {1.0 - row % 2 + 2.0 * (id - first) + 0.5, row + 0.5};
}

double typicalSide(const std::vector<std::vector<cv::Point2f>>& markers) {
  std::vector<double> sides;
  for (const auto& marker : markers) {
    for (std::size_t k = 0; k < 4; ++k) sides.push_back(cv::norm(marker[(k + 1) % 4] - marker[k]));
  }
  return median(std::move(sides));
}

/// Share of the markers that one homography from a board of `cols` squares a row explains.
double shareExplained(const std::vector<std::vector<cv::Point2f>>& markers, const std::vector<int>& ids, int cols, double half_marker) {
  std::vector<cv::Point2d> board, picture;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const cv::Point2d centre = centreOf(ids[k], cols);
    const cv::Point2d corners[] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
    for (std::size_t corner = 0; corner < 4; ++corner) {
      board.push_back(centre + half_marker * corners[corner]);
      picture.emplace_back(markers[k][corner]);
    }
  }
  // A lens bends a board by less; markers in other squares are off by sides.
  const double tolerance = std::max(3.0, 0.25 * typicalSide(markers));
  std::vector<unsigned char> inliers;
  const cv::Mat H = cv::findHomography(board, picture, cv::RANSAC, tolerance, inliers, 500, 0.99);
  if (H.empty()) return 0.0;
  std::size_t explained = 0;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const auto first = inliers.begin() + static_cast<std::ptrdiff_t>(4 * k);
    explained += std::all_of(first, first + 4, [](unsigned char in) { return in != 0; });
  }
  return static_cast<double>(explained) / static_cast<double>(ids.size());
}

}  // namespace

std::optional<std::string> layoutContradiction(const Target& board, const std::vector<std::vector<cv::Point2f>>& markers,
                                               const std::vector<int>& ids) {
  constexpr std::size_t kFewest = 3;
  constexpr double kAgree = 0.5, kExplain = 0.8;
  constexpr int kMostCols = 40;
  if (ids.size() < kFewest) return std::nullopt;
  const double half_marker = 0.5 * board.marker / board.square;
  if (shareExplained(markers, ids, board.cols, half_marker) >= kAgree) return std::nullopt;
  std::string message = fmt::format("the markers do not lie as on a board of {} x {} squares", board.cols, board.rows);
  // Exchanged sides first: that is the usual mistake.
  std::vector<int> candidates{board.rows};
  for (int cols = 2; cols <= kMostCols; ++cols) candidates.push_back(cols);
  for (const int cols : candidates) {
    if (cols == board.cols || shareExplained(markers, ids, cols, half_marker) < kExplain) continue;
    message += fmt::format("; they do on one with {} squares a row", cols);
    if (cols == board.rows) message += ": cols and rows are exchanged";
    return message;
  }
  return message;
}

}  // namespace poecal
