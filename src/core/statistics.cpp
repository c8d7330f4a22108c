#include "poecal/core/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// Ranks from 0, equal values at the mean of theirs.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&values](std::size_t i, std::size_t j) { return values[i] < values[j]; });
  std::vector<double> all(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (std::size_t i = begin; i < end; ++i) all[order[i]] = 0.5 * static_cast<double>(begin + end - 1);
  }
  return all;
}

}  // namespace

double quantile(std::vector<double> values, double p) {
  if (values.empty()) throw InvalidArgument("quantile of no values");
  if (!(p >= 0.0 && p <= 1.0)) throw InvalidArgument("quantile: p must be in [0, 1]");
  std::sort(values.begin(), values.end());
  const double position = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double robustSigma(const std::vector<double>& values) {
  const double middle = median(values);
  std::vector<double> deviations;
  deviations.reserve(values.size());
  for (const double x : values) deviations.push_back(std::abs(x - middle));
  return 1.482602218505602 * median(std::move(deviations));
}

double rms(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) / static_cast<double>(values.size()));
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rankCorrelation(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) throw InvalidArgument("rank correlation of samples of different lengths");
  const std::vector<double> ranks_a = ranks(a), ranks_b = ranks(b);
  const double center = mean(ranks_a);  // as that of the other: n numbers have the same ranks in all
  double product = 0.0, square_a = 0.0, square_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double da = ranks_a[i] - center, db = ranks_b[i] - center;
    product += da * db;
    square_a += da * da;
    square_b += db * db;
  }
  const double scale = std::sqrt(square_a * square_b);
  return scale > 0.0 ? product / scale : 0.0;
}

double chiSquareTail(double x, double dof) {
  if (x <= 0.0) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(dof), x));
}

double chiSquareQuantile(double p, double dof) { return boost::math::quantile(boost::math::chi_squared(dof), p); }

double fTail(double x, double dof1, double dof2) {
  if (x <= 0.0) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(dof1, dof2), x));
}

double normalQuantile(double p) { return boost::math::quantile(boost::math::normal(), p); }

double studentQuantile(double p, double dof) { return boost::math::quantile(boost::math::students_t(dof), p); }

std::pair<double, double> wilsonInterval(int hits, int trials) {
  if (trials <= 0) return {0.0, 1.0};
  const double z = normalQuantile(0.975);
  const double n = trials;
  const double p = hits / n;
  const double centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

}  // namespace poecal
