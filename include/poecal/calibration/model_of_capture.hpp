// Whether a model was found from the cell of a capture.
#pragma once

#include <filesystem>

#include "poecal/capture/capture.hpp"
#include "poecal/identification/model.hpp"

namespace poecal {

/// What a model has in common with every capture of its cell; nullptr where a part is not known.
struct CellParts {
  Setup setup = Setup::kEyeToHand;
  const Arm* arm = nullptr;
  const Camera* camera = nullptr;
  const Target* target = nullptr;
};

/// The parts of a capture, which must outlive them.
CellParts partsOf(const Capture& capture);

/// @throws FileError of `model_file`: the model's arm is another. Where the model has a camera: its setup, its target or the size of its
/// pictures is another.
void requireModelOf(const CellParts& cell, const Model& model, const std::filesystem::path& model_file);

}  // namespace poecal
