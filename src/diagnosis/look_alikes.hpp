// What would look like a finding and nothing recorded tells from it.
#pragma once

#include "diagnosis/selection.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

/// Adds to a finding's alternatives what the capture cannot tell from it for want of a column, of masses or of repeats, takes their share
/// off its probability, and says what would tell them apart.
///
/// A joint that moves at random looks, without poses that the arm came back to, like structure of several joints that is finer than the
/// poses, and, without recorded sides, like play. Play is two-valued: where the joint's errors d_i with deviations s_i are, by
///
///   sum_i log((N(d_i; b, s_i^2) + N(d_i; -b, s_i^2)) / 2) - log N(d_i; 0, b^2 + s_i^2),
///
/// more likely so than at random, it becomes the name. A compliance of a joint that carries links of unknown masses looks like the link
/// before it bending.
/// @param row_order  columns that the order of the rows stands in for.
void addLookAlikes(const Selection& selection, const FoundEffect& found, const RowOrder& row_order, Finding& finding);

/// Whether the arm left a pose and came back to it: other poses lie between its shots.
bool comesBack(const MeasuredCell& measured);

/// Log-likelihood of b or -b at random against a normal deviation b, of errors with their standard deviations, at the best b.
struct TwoValues {
  double log_odds = 0.0;
  double size = 0.0;  ///< b
};
TwoValues twoValues(const Eigen::VectorXd& errors, const Eigen::VectorXd& deviations);

}  // namespace poecal
