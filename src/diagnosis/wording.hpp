// Sizes and shares of a diagnosis as people read them.
#pragma once

#include <algorithm>
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

/// Of a gap that no finding explains.
inline std::string gapRemainsText(const Diagnosis& diagnosis) {
  const double times = diagnosis.after_excess / std::max(diagnosis.noise_rms, 1e-12);
  // A noise that is as large as the gap is what the search could make of it.
  constexpr double kTelling = 2.0, kMost = 1e6;
  return fmt::format("a gap remains that nothing here explains{}: an effect that is not listed, or input that does not belong together",
                     times >= kTelling && times < kMost ? fmt::format(", {:.0f} times the noise", times) : "");
}

}  // namespace poecal
