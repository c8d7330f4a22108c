// Where a radial distortion profile still grows: the test that keeps points beyond its first turning point out.
#pragma once

#include <array>
#include <cstddef>

namespace poecal {

namespace growth_detail {

/// de Casteljau halving of a polynomial in Bernstein form until every piece shows its sign.
template <std::size_t N>
bool bernsteinPositive(std::array<double, N> b, int depth) {
  if (!(b.front() > 0.0) || !(b.back() > 0.0)) return false;
  bool all_positive = true;
  for (const double value : b) all_positive = all_positive && value > 0.0;
  if (all_positive) return true;
  if (depth == 0) return false;
  std::array<double, N> left;
  for (std::size_t i = 0; i < N; ++i) {
    left[i] = b[0];
    for (std::size_t k = 0; k + 1 < N - i; ++k) b[k] = 0.5 * (b[k] + b[k + 1]);
  }
  // What the halving leaves in b is the right half.
  return bernsteinPositive(left, depth - 1) && bernsteinPositive(b, depth - 1);
}

}  // namespace growth_detail

/// Whether c[0] + c[1] s + ... + c[N-1] s^(N-1) > 0 on the whole of [0, end]; false for NaN. A minimum within about 1e-9 of zero
/// may count as not positive.
template <std::size_t N>
bool positiveUpTo(const std::array<double, N>& c, double end) {
  // Enough for nearly every point of a real lens: what the negative terms take away at `end` is the most that they ever take.
  std::array<double, N> scaled;
  double power = 1.0, least = c[0];
  for (std::size_t k = 0; k < N; ++k, power *= end) {
    scaled[k] = c[k] * power;
    if (k > 0 && !(scaled[k] >= 0.0)) least += scaled[k];
  }
  if (least > 0.0) return true;
  // Bernstein coefficients bound the polynomial from both sides: b_i = sum_k C(i, k) / C(N-1, k) c_k end^k.
  std::array<double, N> b;
  for (std::size_t i = 0; i < N; ++i) {
    double ratio = 1.0;
    b[i] = scaled[0];
    for (std::size_t k = 1; k <= i; ++k) {
      ratio *= static_cast<double>(i - k + 1) / static_cast<double>(N - k);
      b[i] += ratio * scaled[k];
    }
  }
  constexpr int kHalvings = 30;
  return growth_detail::bernsteinPositive(b, kHalvings);
}

}  // namespace poecal
