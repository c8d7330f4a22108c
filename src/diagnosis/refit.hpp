// A cell fitted again with effects in it.
#pragma once

#include <vector>

#include "diagnosis/evidence.hpp"

namespace poecal {

/// A state re-fitted with what was accepted, at a noise: Gauss-Newton on the exact residuals, no step of which
/// makes them worse; Linearised::settled says whether it came to rest.
/// @param groups  poses to fit; empty: all.
Linearised refit(const MeasuredCell& measured, ModelState state, std::vector<Accepted> accepted, const std::vector<std::size_t>& scatter,
                 const NoiseEstimate& noise, const std::vector<std::vector<std::size_t>>& groups, bool new_noise);

}  // namespace poecal
