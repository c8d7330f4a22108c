// The inverse of a profile that grows until it ends.
#pragma once

#include <optional>

namespace poecal {

/// t in [0, end] with profile(t) = value by bisection; `profile(t)` returns nothing from some t on, and grows before that. Nothing
/// where the profile ends (or `end` comes) below the value.
template <typename Profile>
std::optional<double> invertGrowing(const Profile& profile, double value, double end) {
  constexpr int kHalvings = 45;  // end / 2^45: closer than Newton's method needs to start from
  double lower = 0.0, upper = end;
  bool reached = false;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (lower + upper);
    const auto at_middle = profile(middle);
    if (at_middle && *at_middle < value) {
      lower = middle;
    } else {
      upper = middle;
      reached = reached || at_middle.has_value();
    }
  }
  // Unless a point above the value was seen, `lower` is where the profile ends.
  if (!reached) return std::nullopt;
  return lower;
}

}  // namespace poecal
