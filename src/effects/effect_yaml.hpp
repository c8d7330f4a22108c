// Effects in scenes, models and truths: a list of {effect, location, driver, parameters}.
#pragma once

#include <string>
#include <vector>

#include "core/yaml.hpp"
#include "poecal/effects/effect.hpp"

namespace poecal {

/// @param as_found  also the keys `units` and `standard_deviation`, as models have them.
/// @throws FileError with the entry's line: what makeEffect says, or an unknown key.
std::vector<AppliedEffect> readEffects(const YamlNode& list, const Cell& cell, bool as_found = false);

/// "effects: []\n", or the key with an entry a line.
std::string effectsYaml(const std::vector<AppliedEffect>& effects);

}  // namespace poecal
