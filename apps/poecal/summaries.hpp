// What people read of a calibration, and the same for programs.
#pragma once

#include <string>

#include "poecal/calibration/run_capture.hpp"

namespace poecal::app {

std::string registrationText(const CalibrationRun& run);
std::string registrationSummaryJson(const CalibrationRun& run);

std::string identificationText(const CalibrationRun& run);

/// The diagnosis, or why there is none, and which model was kept where it is not the diagnosed one.
std::string diagnosisSummary(const CalibrationRun& run, TextLength length);

}  // namespace poecal::app
