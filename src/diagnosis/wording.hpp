// Sizes and shares of a diagnosis as people read them.
#pragma once

#include <string>

#include <fmt/format.h>

namespace poecal {

/// "0.123 px", or of a value in metres "0.123 mm".
inline std::string gapText(bool pixels, double value) {
  return pixels ? fmt::format("{:.3f} px", value) : fmt::format("{:.3f} mm", 1e3 * value);
}

/// "42 %"
inline std::string percentText(double share) { return fmt::format("{:.0f} %", 100.0 * share); }

}  // namespace poecal
