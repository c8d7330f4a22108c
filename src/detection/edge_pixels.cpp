#include "detection/edge_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace poecal {
namespace {

constexpr double kEdgeReach = 2.5;     // [blurs]; what an edge tells falls as exp(-d^2), to 0.2 % here
constexpr double kUnknownReach = 3.0;  // [blurs]; 0.1 % of what lies beyond is mixed in

/// The box about the tag [px], and the largest slopes that a pixel in it has [cells / px].
struct Outline {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  Eigen::Vector2d steepest = Eigen::Vector2d::Zero();
};

Outline outlineOf(const TagPattern& pattern, const LensPatch& lens, const PlaneMap& map) {
  Outline outline;
  const double width = pattern.width();
  for (const Eigen::Vector2d& uv :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(width, 0), Eigen::Vector2d(0, width), Eigen::Vector2d(width, width)}) {
    const Eigen::Vector2d px_straight = map.pixelOf(uv);
    const Eigen::Vector2d px = lens.bend(px_straight);
    const TagView view(uv, map.cellsPerPixel(uv, px_straight) * lens.straighten(px).J_straight_px);
    outline.low = outline.low.cwiseMin(px);
    outline.high = outline.high.cwiseMax(px);
    outline.steepest = outline.steepest.cwiseMax(view.slope);
  }
  return outline;
}

}  // namespace

std::vector<EdgePixel> edgePixels(const cv::Mat& grey, const TagPattern& pattern, const LensPatch& lens, const PlaneMap& map, double blur,
                                  int stride) {
  const Outline outline = outlineOf(pattern, lens, map);
  const Eigen::Vector2d farthest = kEdgeReach * blur * outline.steepest;
  const Eigen::Vector2d centre = 0.5 * (outline.low + outline.high), half = 0.5 * (outline.high - outline.low);
  const int left = std::max(0, static_cast<int>(std::floor(outline.low.x())));
  const int right = std::min(grey.cols - 1, static_cast<int>(std::ceil(outline.high.x())));
  const int top = std::max(0, static_cast<int>(std::floor(outline.low.y())));
  const int bottom = std::min(grey.rows - 1, static_cast<int>(std::ceil(outline.high.y())));
  constexpr std::size_t kUsual = 4000;
  std::vector<EdgePixel> pixels;
  pixels.reserve(kUsual);
  for (int y = top; y <= bottom; y += stride) {
    const std::uint8_t* row = grey.ptr<std::uint8_t>(y);
    const LensPatch::Row lens_row = lens.row(y);
    for (int x = left; x <= right; x += stride) {
      const Eigen::Vector2d uv = map.cellOf(lens_row.straightPixel(x));
      // Most pixels go here, before their own view is worked out.
      if (!pattern.contains(uv) || pattern.isUniformAbout(uv, farthest)) continue;
      const LensPatch::Straight straight = lens_row.straightenExactly(x);
      const TagView view(uv, map.cellsPerPixel(uv, straight.px) * straight.J_straight_px);
      if (surroundings(pattern, view, kEdgeReach * blur, kUnknownReach * blur) != Surroundings::kEdges) continue;
      pixels.push_back({straight.px, view, (Eigen::Vector2d(x, y) - centre).cwiseQuotient(half), static_cast<double>(row[x])});
    }
  }
  return pixels;
}

}  // namespace poecal
