// How noisy a picture is, from what a fit leaves of its grey values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace poecal {

/// Residuals beyond so many noises are no noise: glare, dirt, what is not printed.
inline constexpr double kInliers = 3.0;
/// Least noise of a picture [grey levels]: that of rounding to whole ones.
inline constexpr double kSmallestNoise = 0.3;

struct ResidualNoise {
  double noise = 0.0;     ///< robust standard deviation [grey levels]
  double outliers = 0.0;  ///< share of residuals beyond kInliers noises
};

/// noise = 1.4826 times the median, as of normal residuals. @param absolute  at least one; put into another order.
inline ResidualNoise residualNoise(std::vector<double>& absolute) {
  const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  constexpr double kNormalByMedian = 1.4826;
  ResidualNoise result;
  result.noise = std::max(kSmallestNoise, kNormalByMedian * *middle);
  const double limit = kInliers * result.noise;
  const auto wild = std::count_if(absolute.begin(), absolute.end(), [limit](double r) { return r > limit; });
  result.outliers = static_cast<double>(wild) / static_cast<double>(absolute.size());
  return result;
}

}  // namespace poecal
