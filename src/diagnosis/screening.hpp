// All explanations weighed at once, from one linearisation.
#pragma once

#include <vector>

#include "diagnosis/evidence.hpp"

namespace poecal {

/// Evidence of all candidates at a linearisation and its noise. With x a candidate's columns, W = C^-1 and X, Sigma the columns and the
/// covariance of what the linearisation has already,
///
///   S = x' W x - x' W X Sigma X' W x,   u = x' W (r - X b).
///
/// The poses are passed over in blocks, so that the memory needed beside the linearisation does not grow with their number; the result does
/// not depend on linear.jobs.
std::vector<Evidence> screen(const Linearised& linear, const std::vector<Candidate>& candidates);

}  // namespace poecal
