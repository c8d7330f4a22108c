// The cell as a search leaves it: geometry, effects and how well each is known.
#pragma once

#include <vector>

#include "diagnosis/selection.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

/// Standard deviations of the linear parameters of each accepted effect, or of its curve's factors, and after them those of its mass
/// errors, from the covariance of the last fit.
std::vector<Eigen::VectorXd> parameterDeviations(const Selection& selection);

/// Covariance of a finding's factors from the last fit. The finding is an accepted effect.
Eigen::MatrixXd factorCovariance(const Selection& selection, std::size_t finding);

/// b' C^-1 b of a finding's factors: how far all of them together are from nothing.
double factorsChiSquare(const Selection& selection, std::size_t finding);

/// Of a joint that moves at random [rad] or [m].
double scatterSigma(const Selection& selection, const FoundEffect& found);

/// The model with its effects, and how the axes moved when these came in.
void tellModel(const Selection& selection, const Identification& identification, Diagnosis& diagnosis);

}  // namespace poecal
