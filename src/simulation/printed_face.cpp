#include "simulation/printed_face.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace poecal {
namespace {

// Edges of neighbouring cells come from different sums and may differ by rounding; a nanometre is far below what any picture shows.
constexpr double kSameEdge = 1e-9;

std::vector<double> sortedEdges(std::vector<double> edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end(), [](double a, double b) { return b - a < kSameEdge; }), edges.end());
  return edges;
}

std::size_t edgeIndex(const std::vector<double>& edges, double value) {
  return static_cast<std::size_t>(std::lower_bound(edges.begin(), edges.end(), value - kSameEdge) - edges.begin());
}

/// A convex polygon; a cut adds one corner at most, and there are four cuts to a cell.
class Polygon {
 public:
  explicit Polygon(const Eigen::Matrix<double, 2, 4>& corners) : count_(4) {
    for (int k = 0; k < 4; ++k) corners_[static_cast<std::size_t>(k)] = corners.col(k);
  }

  /// What is not below (above, with side -1) `level` along an axis.
  Polygon cut(Eigen::Index axis, double level, double side) const {
    Polygon kept;
    for (std::size_t k = 0; k < count_; ++k) {
      const Eigen::Vector2d &a = corners_[k], &b = corners_[(k + 1) % count_];
      const double from = side * (a(axis) - level), to = side * (b(axis) - level);
      if (from >= 0.0) kept.corners_[kept.count_++] = a;
      if ((from < 0.0) != (to < 0.0)) kept.corners_[kept.count_++] = a + from / (from - to) * (b - a);
    }
    return kept;
  }

  double area() const {
    double twice = 0.0;
    for (std::size_t k = 2; k < count_; ++k) {
      const Eigen::Vector2d a = corners_[k - 1] - corners_[0], b = corners_[k] - corners_[0];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return 0.5 * std::abs(twice);
  }

 private:
  Polygon() = default;

  std::array<Eigen::Vector2d, 8> corners_;
  std::size_t count_ = 0;
};

}  // namespace

PrintedFace::PrintedFace(const Eigen::Isometry3d& T_target_face, const std::vector<PaintedRectangle>& painted)
    : T_target_face_(T_target_face) {
  assert(!painted.empty());
  std::vector<double> xs, ys;
  for (const PaintedRectangle& rectangle : painted) {
    xs.insert(xs.end(), {rectangle.box.min().x(), rectangle.box.max().x()});
    ys.insert(ys.end(), {rectangle.box.min().y(), rectangle.box.max().y()});
  }
  x_edges_ = sortedEdges(std::move(xs));
  y_edges_ = sortedEdges(std::move(ys));
  const std::size_t columns = x_edges_.size() - 1;
  cells_.assign(columns * (y_edges_.size() - 1), Tile::kNone);
  for (const PaintedRectangle& rectangle : painted) {
    const std::size_t x_end = edgeIndex(x_edges_, rectangle.box.max().x());
    const std::size_t y_end = edgeIndex(y_edges_, rectangle.box.max().y());
    for (std::size_t y = edgeIndex(y_edges_, rectangle.box.min().y()); y < y_end; ++y) {
      for (std::size_t x = edgeIndex(x_edges_, rectangle.box.min().x()); x < x_end; ++x) cells_[y * columns + x] = rectangle.tile;
    }
  }
}

Eigen::AlignedBox2d PrintedFace::bounds() const {
  return {Eigen::Vector2d(x_edges_.front(), y_edges_.front()), Eigen::Vector2d(x_edges_.back(), y_edges_.back())};
}

std::vector<Eigen::AlignedBox2d> PrintedFace::runs(Tile tile) const {
  std::vector<Eigen::AlignedBox2d> boxes;
  const std::size_t columns = x_edges_.size() - 1;
  for (std::size_t y = 0; y + 1 < y_edges_.size(); ++y) {
    for (std::size_t x = 0, end = 0; x < columns; x = end + 1) {
      end = x;
      while (end < columns && cells_[y * columns + end] == tile) ++end;
      if (end > x) boxes.push_back({Eigen::Vector2d(x_edges_[x], y_edges_[y]), Eigen::Vector2d(x_edges_[end], y_edges_[y + 1])});
    }
  }
  return boxes;
}

int PrintedFace::cellAt(double x, double y) const {
  const auto x_upper = std::upper_bound(x_edges_.begin(), x_edges_.end(), x);
  const auto y_upper = std::upper_bound(y_edges_.begin(), y_edges_.end(), y);
  if (x_upper == x_edges_.begin() || x_upper == x_edges_.end() || y_upper == y_edges_.begin() || y_upper == y_edges_.end()) return -1;
  const auto columns = static_cast<std::ptrdiff_t>(x_edges_.size()) - 1;
  return static_cast<int>((y_upper - y_edges_.begin() - 1) * columns + (x_upper - x_edges_.begin() - 1));
}

TileShares PrintedFace::shares(const Eigen::Matrix<double, 2, 4>& corners) const {
  // The strips of a direction that [low, high] meets.
  const auto strips = [](const std::vector<double>& edges, double low, double high) {
    const auto first = std::upper_bound(edges.begin(), edges.end(), low), last = std::lower_bound(edges.begin(), edges.end(), high);
    return std::pair(std::max<std::ptrdiff_t>(first - edges.begin() - 1, 0),
                     std::min<std::ptrdiff_t>(last - edges.begin(), static_cast<std::ptrdiff_t>(edges.size()) - 1));
  };
  const Eigen::Vector2d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
  const auto [left, right] = strips(x_edges_, low.x(), high.x());
  const auto [top, bottom] = strips(y_edges_, low.y(), high.y());
  const Polygon whole(corners);
  const double area = whole.area();
  TileShares shares{};
  double painted = 0.0;
  for (auto x = static_cast<std::size_t>(left); x < static_cast<std::size_t>(right); ++x) {
    const Polygon strip = whole.cut(0, x_edges_[x], 1.0).cut(0, x_edges_[x + 1], -1.0);
    for (auto y = static_cast<std::size_t>(top); y < static_cast<std::size_t>(bottom); ++y) {
      const double share = strip.cut(1, y_edges_[y], 1.0).cut(1, y_edges_[y + 1], -1.0).area() / area;
      shares[static_cast<std::size_t>(cells_[y * (x_edges_.size() - 1) + x])] += share;
      painted += share;
    }
  }
  // What rounding leaves of a square without a gap is none.
  constexpr double kRounding = 1e-9;
  if (painted < 1.0 - kRounding) shares[static_cast<std::size_t>(Tile::kNone)] += 1.0 - painted;
  return shares;
}

}  // namespace poecal
