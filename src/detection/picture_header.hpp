// The size of a picture as its file states it: what is read before anything is decoded.
#pragma once

#include <optional>
#include <string_view>

#include "poecal/capture/detections.hpp"

namespace poecal {

/// Width and height in the header of a PNG, JPEG, TIFF, BMP or PNM file; nothing where it is none of these or its header is not whole.
/// Sizes beyond what an int holds are the largest int.
std::optional<ImageSize> sizeInHeader(std::string_view bytes);

}  // namespace poecal
