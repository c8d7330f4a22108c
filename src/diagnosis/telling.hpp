// What a search found, as a Diagnosis says it: each function fills its own part.
#pragma once

#include <vector>

#include "diagnosis/selection.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

/// The findings with their parameters, probabilities and alternatives; without shrinkage.
/// @param row_order  columns that the order of the rows stands in for.
Diagnosis tellFindings(const Selection& selection, const RowOrder& row_order);

void tellNoise(const Selection& selection, Diagnosis& diagnosis);

/// Noise beyond that of any arm or printed target: a gap remains then, unless repeats show that the arm does not come back. After
/// tellNoise().
void tellTooMuchNoise(const Selection& selection, Diagnosis& diagnosis);

/// Gains of -1, which take a joint's readings back.
void tellUnmoved(Diagnosis& diagnosis);

/// Whether gravity is stated the other way round than what yields to it tells.
void tellContradictions(const Selection& selection, Diagnosis& diagnosis);

/// Places and drivers at which the identified model leaves structure, by the noise that remains at the end.
void tellWhere(const Selection& selection, Diagnosis& diagnosis);

/// Whether there is structure yet beside all findings, and where most of it.
void tellRemaining(const Selection& selection, Diagnosis& diagnosis);

/// The smallest size of each effect that the capture would have shown, and what it cannot tell of and why.
void tellWhatCanBeSeen(const Selection& selection, Diagnosis& diagnosis);

/// Every answer that was weighed.
void tellExplained(const Selection& selection, Diagnosis& diagnosis);

/// The rows that belong to no model, and the finding that they are.
/// @param observations, samples  that were given, which the selection's numbers are of.
void tellBad(const Selection& selection, const std::vector<Observation>& observations, const std::vector<Sample>& samples,
             Diagnosis& diagnosis);

}  // namespace poecal
