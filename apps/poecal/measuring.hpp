// Registration of a capture with its files and words, for `measure` and `run`.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "inputs.hpp"
#include "poecal/registration/registration.hpp"

namespace poecal::app {

struct Measuring {
  RegistrationResult registration;
  std::string text;
  nlohmann::json json;
};

/// Registers a capture, writes OUT/registration.yaml and OUT/flange_poses.csv, and words the result.
Measuring measureCapture(const CaptureInputs& inputs, const std::filesystem::path& out);

}  // namespace poecal::app
