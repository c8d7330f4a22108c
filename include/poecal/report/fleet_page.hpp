// The results of many captures as one page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/calibration/results.hpp"

namespace poecal {

/// A table of all captures with a small picture of each: its errors from the nominal arm to the model with the findings. Where a capture
/// has a report.html, its name leads there.
/// @param page  where the page will stand, for these links.
/// @throws InvalidArgument as requireReport().
std::string fleetHtml(const std::vector<ResultSummary>& results, const std::filesystem::path& page);

}  // namespace poecal
