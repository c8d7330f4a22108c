// Rows that belong to no model: those whose joints and picture do not belong together.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/evidence.hpp"
#include "diagnosis/thresholds.hpp"

namespace poecal {

/// Rows of a linearisation with its noise that belong to no model, as indices into the measured observations, ascending. Of a pose that was
/// taken several times those shots alone whose absence leaves shots that do belong. None where their poses are a run at the end or the
/// start of the session, which is something that moved, or more than a third, which is no sprinkling of wild rows.
std::vector<std::size_t> wildRows(const MeasuredCell& measured, const Linearised& linear, const Wild& wild);

/// Whether three or more poses, as indices into the groups, are the first or the last of the session.
bool isRunInTime(const MeasuredCell& measured, const std::vector<std::size_t>& poses);

/// Poses that were not fitted and that the model explains as well as it does those that were, as indices into their groups.
/// @param fitted  with its noise. @param others  the poses that were not fitted, linearised at the same model.
std::vector<std::size_t> explainedPoses(const Linearised& fitted, const Linearised& others);

/// Root of the mean square of what each observation is off by [px, or m where poses].
std::vector<double> rmsOfEach(const CaptureRows& rows);

}  // namespace poecal
