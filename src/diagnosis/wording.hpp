// Sizes and shares of a diagnosis as people read them.
#pragma once

#include <string>

#include <fmt/format.h>

#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

/// A rms of a diagnosis: "0.123 px", or of one without pictures, whose values are in metres, "0.123 mm".
inline std::string gapText(const Diagnosis& diagnosis, double value) {
  return diagnosis.pixels ? fmt::format("{:.3f} px", value) : fmt::format("{:.3f} mm", 1e3 * value);
}

/// "42 %"
inline std::string percentText(double share) { return fmt::format("{:.0f} %", 100.0 * share); }

}  // namespace poecal
