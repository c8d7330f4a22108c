// Statistics that the estimators share: robust scale, tails and quantiles of the usual distributions.
#pragma once

#include <utility>
#include <vector>

namespace poecal {

/// Median; the mean of the middle two for an even count. @throws InvalidArgument if empty.
double median(std::vector<double> values);
/// Quantile by linear interpolation between order statistics, p in [0, 1]. @throws InvalidArgument if empty or p outside.
double quantile(std::vector<double> values, double p);
/// 1.4826 median |x - median x|: the standard deviation of a normal sample, whatever up to half of the values are.
double robustSigma(const std::vector<double>& values);
/// sqrt(sum x^2 / N); 0 for an empty sample.
double rms(const std::vector<double>& values);
double mean(const std::vector<double>& values);
/// Spearman's rank correlation of two samples, equal values at their mean rank; 0 where one of them is constant,
/// or both are empty. @throws InvalidArgument if they differ in length.
double rankCorrelation(const std::vector<double>& a, const std::vector<double>& b);

/// P(X > x) for X ~ chi-square with `dof` degrees of freedom.
double chiSquareTail(double x, double dof);
/// x with P(X <= x) = p.
double chiSquareQuantile(double p, double dof);
/// P(X > x) for X ~ F(dof1, dof2).
double fTail(double x, double dof1, double dof2);
/// x with P(X <= x) = p, X standard normal.
double normalQuantile(double p);
/// x with P(X <= x) = p for Student's t.
double studentQuantile(double p, double dof);
/// Wilson score interval of a proportion at 95 %: (lower, upper) for `hits` of `trials`.
std::pair<double, double> wilsonInterval(int hits, int trials);

}  // namespace poecal
