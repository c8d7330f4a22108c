// Image quality: how sharp and how noisy pictures are, measured on the tags in them. The table beside detections.csv.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace poecal {

struct Detections;

constexpr double kLargestBlur = 30.0;    ///< [px]; what is blurred more is no picture of anything
constexpr double kLargestNoise = 255.0;  ///< [grey levels of 255]

/// Blur and noise mean the same as in a scene's `image:`.
struct PictureLook {
  double blur = 0.0;    ///< standard deviation of the lens's point spread, without the pixel's own square [px]
  double noise = 0.0;   ///< standard deviation of a pixel's noise, without its rounding [grey levels of 255]
  double growth = 0.0;  ///< of dark into light (ink, bloom, gamma), to each side of an edge [px]; negative: light grows into dark
};

/// The median of each figure by itself; nothing where there are no looks.
std::optional<PictureLook> medianLook(const std::vector<PictureLook>& looks);

/// The file beside `detections` that says what its pictures look like: detections.csv -> detections-pictures.csv.
std::filesystem::path picturesFile(const std::filesystem::path& detections);

/// `image,blur,noise,growth`, a row for each picture that has a look.
std::string picturesCsv(const Detections& detections);

/// Looks in the order of the rows. Other columns are ignored; a missing growth is 0.
/// @throws FileError with the line: not a number, a blur or noise below 0 or above its largest; line 1 where there is no row.
std::vector<PictureLook> readPictureLooks(const std::filesystem::path& file);

}  // namespace poecal
