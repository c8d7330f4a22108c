#include "detection/grid_corners.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>

#include "detection/subpixel.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

cv::Point2d map(const cv::Matx33d& H, const Eigen::Vector2d& p) {
  const cv::Vec3d image = H * cv::Vec3d(p.x(), p.y(), 1.0);
  return {image[0] / image[2], image[1] / image[2]};
}

/// The board's plane seen in the picture.
class GridView {
 public:
  GridView(const Target& grid, const cv::Mat& grey, const cv::Matx33d& H)
      : grid_(grid), grey_(grey), H_(H), gap_(grid.tag_spacing * grid.tags.front().size) {}

  cv::Point2d pixelOf(const Eigen::Vector3d& p_target) const { return map(H_, p_target.head<2>()); }

  /// Half the gap's width about a point of the board [px].
  double halfGapPx(const Eigen::Vector3d& p_target) const {
    const cv::Point2d here = pixelOf(p_target);
    return 0.5 * std::min(cv::norm(map(H_, p_target.head<2>() + Eigen::Vector2d(gap_, 0.0)) - here),
                          cv::norm(map(H_, p_target.head<2>() + Eigen::Vector2d(0.0, gap_)) - here));
  }

  /// Whether a corner is a saddle: dark inside the tag and diagonally outside of it, bright on both sides of that diagonal.
  bool isSaddle(const TargetTag& tag, int corner) const {
    const Eigen::Vector3d p = grid_.find({tag.id, corner})->p_target;
    const Eigen::Vector2d outward = 2.0 / tag.size * (p - tag.T_target_tag.translation()).head<2>();  // (+-1, +-1)
    const double reach = std::min(0.3 * gap_, tag.size / 20.0);                                       // inside the black border of one cell
    const auto grey = [&](double along_x, double along_y) {
      return sample(map(H_, p.head<2>() + reach * Eigen::Vector2d(along_x * outward.x(), along_y * outward.y())));
    };
    const double dark = std::max(grey(1, 1), grey(-1, -1));
    const double bright = std::min(grey(1, -1), grey(-1, 1));
    constexpr double kContrast = 20.0;  // grey levels, well above any noise of a usable picture
    return bright > dark + kContrast;
  }

 private:
  /// Grey value at a pixel, bilinear; not a number outside of the picture.
  double sample(const cv::Point2d& px) const {
    if (px.x < 0.0 || px.y < 0.0 || px.x > grey_.cols - 2.0 || px.y > grey_.rows - 2.0) return std::nan("");
    const int x = static_cast<int>(px.x), y = static_cast<int>(px.y);
    const double fx = px.x - x, fy = px.y - y;
    const auto at = [this](int row, int col) { return static_cast<double>(grey_.at<unsigned char>(row, col)); };
    return (1.0 - fy) * ((1.0 - fx) * at(y, x) + fx * at(y, x + 1)) + fy * ((1.0 - fx) * at(y + 1, x) + fx * at(y + 1, x + 1));
  }

  const Target& grid_;
  const cv::Mat& grey_;
  cv::Matx33d H_;
  double gap_;
};

double medianSide(const std::vector<Corner>& corners) {
  std::vector<double> sides;
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    if (corners[k].id.tag == corners[k + 1].id.tag) sides.push_back((corners[k].px - corners[k + 1].px).norm());
  }
  return median(std::move(sides));
}

/// Drops the tags that a homography leaves farther than `tolerance` [px].
void dropStrays(const Target& grid, const cv::Matx33d& H, double tolerance, std::vector<Corner>& corners) {
  std::vector<int> strays;
  for (const Corner& corner : corners) {
    const cv::Point2d expected = map(H, grid.find(corner.id)->p_target.head<2>());
    if (std::hypot(corner.px.x() - expected.x, corner.px.y() - expected.y) > tolerance) strays.push_back(corner.id.tag);
  }
  std::erase_if(corners, [&](const Corner& corner) { return std::find(strays.begin(), strays.end(), corner.id.tag) != strays.end(); });
}

/// Whether most corners in view are saddles.
bool hasSquares(const Target& grid, const GridView& view, const std::vector<Corner>& corners) {
  std::size_t saddles = 0;
  for (const Corner& corner : corners) {
    const auto tag = std::find_if(grid.tags.begin(), grid.tags.end(), [&](const TargetTag& t) { return t.id == corner.id.tag; });
    saddles += view.isSaddle(*tag, corner.id.corner);
  }
  return 2 * saddles > corners.size();
}

/// Saddles in windows of 5 to 10 px at a noise of 2 grey levels [px].
constexpr double kSaddleSigma = 0.03;

std::vector<Corner> saddles(const Target& grid, const GridView& view, const cv::Mat& grey) {
  std::vector<Corner> found;
  for (const TargetTag& tag : grid.tags) {
    for (int corner = 0; corner < 4; ++corner) {
      if (!view.isSaddle(tag, corner)) continue;
      const TargetPoint& point = *grid.find({tag.id, corner});
      const double reach = 0.8 * view.halfGapPx(point.p_target);
      const cv::Point2d expected = view.pixelOf(point.p_target);
      std::vector<cv::Point2f> px{cv::Point2f(expected)};
      refineSaddles(grey, px, reach);
      if (cv::norm(cv::Point2d(px.front()) - expected) > std::max(2.0, reach)) continue;
      found.push_back({point.id, {static_cast<double>(px.front().x), static_cast<double>(px.front().y)}, kSaddleSigma});
    }
  }
  return found;
}

}  // namespace

void settleGridCorners(const Target& grid, const cv::Mat& grey, std::vector<Corner>& corners) {
  if (corners.size() < 8) return;
  std::vector<cv::Point2d> board, picture;
  for (const Corner& corner : corners) {
    const Eigen::Vector3d& p = grid.find(corner.id)->p_target;
    board.emplace_back(p.x(), p.y());
    picture.emplace_back(corner.px.x(), corner.px.y());
  }
  // A lens bends the board by less than this; a corner that a neighbouring square has drawn away is off by more.
  const double tolerance = std::max(3.0, 0.1 * medianSide(corners));
  const cv::Mat H = cv::findHomography(board, picture, cv::RANSAC, tolerance, cv::noArray(), 2000, 0.999);
  if (H.empty()) return;
  dropStrays(grid, H, tolerance, corners);
  const GridView view(grid, grey, H);
  if (!corners.empty() && hasSquares(grid, view, corners)) corners = saddles(grid, view, grey);
}

}  // namespace poecal
