// report.json before it is text.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "poecal/calibration/run_capture.hpp"

namespace poecal {

/// What reportJson() writes.
nlohmann::ordered_json reportObject(const CalibrationRun& run, const std::string& pictures);
/// Its text.
std::string reportText(const nlohmann::ordered_json& report);

}  // namespace poecal
