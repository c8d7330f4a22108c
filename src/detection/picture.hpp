// A picture from its file, as the 8-bit grey that detectors want.
#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core/mat.hpp>

namespace poecal {

struct Picture {
  cv::Mat grey;         ///< 8-bit, one channel; empty where the file gave no picture
  std::string problem;  ///< why it is empty, one sentence
};

/// Reads PNG, JPEG, TIFF or BMP, grey or colour, 8 or 16 bit, with its pixels where the sensor had them: an orientation tag of the camera
/// is not applied. 16-bit values are scaled by their full range, 65535, or by 4095 where none is larger: 12-bit cameras write theirs
/// unscaled.
Picture readPicture(const std::filesystem::path& file);

}  // namespace poecal
