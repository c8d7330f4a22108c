// The keys of a YAML or JSON file and the columns of a CSV file.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace poecal::test {

/// "gap.stages[].rms_px" for every value of a YAML or JSON file; the columns of a CSV file. Sizes of effects are passed over: their names
/// are the catalogue's.
std::set<std::string> keysOf(const std::filesystem::path& file);

/// The last part of a key: "rms_px".
std::string lastPart(const std::string& key);

}  // namespace poecal::test
