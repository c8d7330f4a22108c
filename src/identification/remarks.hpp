// What an identification says beside its figures: rows that contradict it, an arm that is not its file's, what no data can tell.
#pragma once

#include <string>
#include <vector>

#include "identification/fit.hpp"

namespace poecal {

/// Rows of which some corner, or the pose, lost weight. @param fitted  what the fit saw: the observations, or measured flange poses.
std::vector<SuspectRow> suspectRows(const MethodFit& fit, const Cell& cell, const std::vector<Observation>& fitted);

/// An arm that is identified from what belongs to it puts the flange to some centimetres of where it was, whatever effects it has.
/// @param errors  of the poses that it was identified from.
/// @throws ImplausibleCapture: their median is half of how far the poses lie apart, and 0.1 m; or 1 rad.
void requireExplained(const Arm& nominal, const std::vector<Observation>& observations, const ErrorSummary& errors);

/// What no tolerance makes: the arm is then another than its file says. A zero of 0.03 rad and more, an axis ten tolerances away.
std::vector<std::string> deviationWarnings(const Arm& nominal, const std::vector<JointDeviation>& deviations,
                                           const IdentifyOptions& options);

/// Whether deviations were stated that are thirty times what the fit leaves, or more: of another unit. Empty where not. Smaller ones than
/// that nobody tells from a gap. @param scale  what is left, of what was stated
std::string statedDeviationsWarning(double scale, bool corners);

/// Whether some rows state deviations a fiftieth of what others state or less, and are five times farther off by what they state than
/// those: another unit in a part of the rows. Empty where not.
std::string mixedDeviationsWarning(const Cell& cell, const std::vector<Observation>& observations);

/// What no data of this kind can tell, by name, and how it was fixed.
std::vector<std::string> gaugeRemarks(const Arm& nominal, const MethodFit& fit, bool registered);

/// The intrinsics that moved by more than three standard deviations of the fit, at most four, farthest first.
std::string lensMoveText(const MethodFit& fit, const Camera& stated);
/// Whether a lens with stated deviations had to move far beyond them, and how; empty where it had not.
std::string lensMoveWarning(const MethodFit& fit, const Camera& stated);

}  // namespace poecal
