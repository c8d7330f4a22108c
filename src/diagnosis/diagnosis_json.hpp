// diagnosis.json before it is text: a calibration adds what it knows.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

nlohmann::ordered_json diagnosisObject(const Diagnosis& diagnosis, const std::vector<Sample>& samples);

}  // namespace poecal
