#include "simulation/printed_face.hpp"

#include <algorithm>
#include <cassert>

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

int PrintedFace::cellAt(double x, double y) const {
  const auto x_upper = std::upper_bound(x_edges_.begin(), x_edges_.end(), x);
  const auto y_upper = std::upper_bound(y_edges_.begin(), y_edges_.end(), y);
  if (x_upper == x_edges_.begin() || x_upper == x_edges_.end() || y_upper == y_edges_.begin() || y_upper == y_edges_.end()) return -1;
  const auto columns = static_cast<std::ptrdiff_t>(x_edges_.size()) - 1;
  return static_cast<int>((y_upper - y_edges_.begin() - 1) * columns + (x_upper - x_edges_.begin() - 1));
}

}  // namespace poecal
