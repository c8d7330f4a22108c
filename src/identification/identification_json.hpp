// identification.json before it is text.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "poecal/identification/identify.hpp"

namespace poecal {

/// @param samples  that the suspects are of.
nlohmann::ordered_json identificationObject(const Identification& identification, const std::vector<Sample>& samples);

}  // namespace poecal
