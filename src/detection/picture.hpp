// A picture from its file, as the 8-bit grey that detectors want.
#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core/mat.hpp>

namespace poecal {

/// The bytes of a picture's file.
struct PictureFile {
  std::string bytes;
  std::string problem;  ///< why there are none, one sentence
};
PictureFile readPictureFile(const std::filesystem::path& file);

struct Picture {
  cv::Mat grey;         ///< 8-bit, one channel; empty where the file gave no picture
  std::string problem;  ///< why it is empty, one sentence
};

/// Decodes PNG, JPEG, TIFF or BMP, grey or colour, 8 or 16 bit, with its pixels where the sensor had them: an orientation tag of the camera
/// is not applied. Pictures of more than kMostPixels are not decoded: a file of a few bytes may state any size. 16-bit values are scaled by
/// their full range, 65535, or by 4095 where none is larger: 12-bit cameras write theirs unscaled.
Picture decodePicture(const PictureFile& file);

/// decodePicture(readPictureFile(file)).
Picture readPicture(const std::filesystem::path& file);

}  // namespace poecal
