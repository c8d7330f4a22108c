// What an observer who is told everything, and simple diagnoses, would have said of a case, for comparison. They are given more than poecal
// is: the true geometry to linearise at, the true noise, and the true masses.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "withheld/case.hpp"

namespace withheld {

/// "effect@location" that each baseline finds:
/// - "observer": the most probable listed effect by Bayes' rule, all sizes and instances of it summed; one at most. What it cannot tell
/// apart
///   nobody can
/// - "smallest p-value": the listed effect whose score test has the smallest p-value, where that is below 1 % by Bonferroni; one at most
/// - "BIC": forward selection by the Bayesian information criterion, four at most
/// - "always elasticity": the joint_compliance that explains most, whatever there is
/// Cases with missing tags or wild rows have none.
std::map<std::string, std::vector<std::string>> baselines(const Case& made);

/// log of the probability that chi-square with `freedom` degrees exceeds x; accurate where the probability itself would be zero.
double logChiSquareTail(double x, double freedom);

}  // namespace withheld
