// The map of a camera.yaml, also where it is part of another file (model.yaml, under `camera:`).
#pragma once

#include <string>

#include "core/yaml.hpp"
#include "poecal/camera/camera.hpp"

namespace poecal {

enum class SizeKeys { kNeeded, kMayBeMissing };

/// @throws FileError as readCamera.
Camera parseCamera(const YamlNode& node, SizeKeys size = SizeKeys::kNeeded);

/// The map's lines, each behind `indent` spaces; numbers read back as the same bits. All coefficients of the model are written. A
/// standard deviation that is not finite is left out, and the whole map where none is stated.
std::string cameraYamlBlock(const Camera& camera, int indent);

}  // namespace poecal
