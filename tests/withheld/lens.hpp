// The camera of the withheld world: Brown's lens, written out.
#pragma once

#include <Eigen/Core>

#include "withheld/frames.hpp"

namespace withheld {

struct Lens {
  int width = 2448, height = 2048;
  double fx = 2400.0, fy = 2400.0, cx = 1223.5, cy = 1023.5;  ///< [px]
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0;

  /// Pixel of a point in camera (z forward, z > 0) [m]. Brown 1971 as OpenCV orders its terms, k3 = 0.
  Eigen::Vector2d image(const Vector& p) const {
    const double x = p.x() / p.z(), y = p.y() / p.z();
    const double r2 = x * x + y * y;
    const double stretch = 1.0 + r2 * (k1 + r2 * k2);
    const double u = x * stretch + p1 * 2.0 * x * y + p2 * (r2 + 2.0 * x * x);
    const double v = y * stretch + p2 * 2.0 * x * y + p1 * (r2 + 2.0 * y * y);
    return {cx + fx * u, cy + fy * v};
  }
  /// The point at z = 1 whose pixel this is, as far as the polynomial reaches.
  Eigen::Vector2d ray(const Eigen::Vector2d& px) const {
    constexpr int kRounds = 60;
    constexpr double kSame = 1e-12;
    const double u = (px.x() - cx) / fx, v = (px.y() - cy) / fy;
    Eigen::Vector2d at(u, v);
    for (int round = 0; round < kRounds; ++round) {
      const double x = at.x(), y = at.y(), r2 = x * x + y * y;
      const double stretch = 1.0 + r2 * (k1 + r2 * k2);
      const Eigen::Vector2d next((u - p1 * 2.0 * x * y - p2 * (r2 + 2.0 * x * x)) / stretch,
                                 (v - p2 * 2.0 * x * y - p1 * (r2 + 2.0 * y * y)) / stretch);
      const double step = (next - at).norm();
      at = next;
      if (step < kSame) break;
    }
    return at;
  }
  /// Whether rays this far out still go outwards in the picture: a polynomial folds beyond, and no lens does.
  bool reaches(const Vector& p) const {
    constexpr double kWidest = 1.0;  // tangent; the picture's corners are at 0.75
    const double r2 = (p.x() * p.x() + p.y() * p.y()) / (p.z() * p.z());
    return p.z() > 0.0 && r2 < kWidest && 1.0 + r2 * (3.0 * k1 + r2 * 5.0 * k2) > 0.1;
  }
  bool shows(const Eigen::Vector2d& px, double margin) const {
    return px.x() > margin && px.y() > margin && px.x() < width - 1.0 - margin && px.y() < height - 1.0 - margin;
  }
};

}  // namespace withheld
