// Where the effects of a model were found: the range of what drives them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "poecal/capture/capture.hpp"
#include "poecal/effects/effect.hpp"

namespace poecal {

/// Lowest and highest `stamp` [s], `temperature` [degrees Celsius] and `payload` [kg], by name.
using DriverRanges = std::map<std::string, std::pair<double, double>>;

/// The ranges over samples of what drives some of the effects: a payload, 0 where none is stated, drives what yields to gravity. Other
/// columns that no sample has are left out.
DriverRanges driverRangesOf(const std::vector<AppliedEffect>& effects, const std::vector<Sample>& samples);

/// Rows beyond a range by more than its width, where no capture shows the effect. One sentence for each column, with file and line of the
/// first such row.
std::vector<std::string> remarksOnDrivers(const DriverRanges& ranges, const std::filesystem::path& file,
                                          const std::vector<Sample>& samples);

}  // namespace poecal
