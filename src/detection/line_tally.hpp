// Whether what a fit of a tag leaves is noise, or agrees along the lines of the pattern.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace poecal {

/// How far the residuals want to move single lines of the pattern, which a fit to noise alone leaves to chance.
class LineTally {
 public:
  /// @param width  of the pattern [cells].
  explicit LineTally(int width) : pulls_(static_cast<std::size_t>(2 * (width + 1))) {}

  /// A pixel at `uv` [cells]. @param slope  derivatives of its grey value across the lines of both directions [1 / px].
  void add(const Eigen::Vector2d& uv, const Eigen::Vector2d& slope, double residual);

  /// Mean square of score / sqrt(information) over the lines, eight of which the corners have made fit; 1 where residuals are noise
  /// of that variance, more where they agree along lines.
  double coherence(double variance) const;

 private:
  struct Pull {
    double score = 0.0, information = 0.0;
  };
  std::vector<Pull> pulls_;
};

}  // namespace poecal
