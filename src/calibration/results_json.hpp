// diagnosis.json of a calibration before it is text.
#pragma once

#include <nlohmann/json.hpp>

#include "poecal/calibration/results.hpp"

namespace poecal {

/// What diagnosisJson() writes. @throws InvalidArgument where no diagnosis was asked for.
nlohmann::ordered_json diagnosisObject(const Calibration& calibration, const Measurements& measurements);

}  // namespace poecal
