// The results of many captures side by side, read from the files that the stages wrote.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace poecal::app {

/// One result folder, by fleetColumns(). What a stage that was not run would have written is null, as is what it could not tell.
using FleetRow = nlohmann::ordered_json;

/// What a row holds, in its order. _px, _mm and _mrad of nominal, registered, identified and diagnosed are on poses that the fit did not
/// see: pixels rms, the flange in the mean.
const std::vector<std::string>& fleetColumns();

/// Reads registration.yaml, identification.json and diagnosis.json of a folder; none of them need be there.
/// @throws FileError where there is no such folder, or with file and line where one of them is not what its stage writes.
FleetRow readFleetRow(const std::filesystem::path& folder);

/// fleet.csv: a row for each folder, lists joined by "; ", null as an empty cell.
std::string fleetCsv(const std::vector<FleetRow>& rows);

/// A table for people.
std::string fleetText(const std::vector<FleetRow>& rows);

}  // namespace poecal::app
