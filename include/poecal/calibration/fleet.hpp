// The results of many captures side by side.
#pragma once

#include <string>
#include <vector>

#include "poecal/calibration/results.hpp"

namespace poecal {

/// What a row of fleet.csv holds, in its order. _px, _mm and _mrad of nominal, registered, identified and diagnosed are on held-out poses:
/// pixels rms, the flange in the mean.
const std::vector<std::string>& fleetColumns();

/// The cells of a row by their columns; what a step that was not run would have given is an empty cell, lists are joined by "; ".
std::vector<std::string> fleetRow(const ResultSummary& summary);

/// fleet.csv: a row for each result.
std::string fleetCsv(const std::vector<ResultSummary>& results);

/// A table for people.
std::string fleetText(const std::vector<ResultSummary>& results);

}  // namespace poecal
