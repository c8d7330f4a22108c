// detections.csv: the corners of every picture.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "poecal/capture/picture_look.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// One corner in a picture.
struct Corner {
  PointId id;
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< [px] per axis; NaN where not stated
};

/// The corners of one picture, sorted by id.
struct ImageCorners {
  std::string image;
  std::vector<Corner> corners;
  std::optional<PictureLook> look = std::nullopt;  ///< where a tag was fitted to the picture; it is not in detections.csv
};

/// Pictures in the order of the capture (or of first appearance in the file); a picture without corners may be absent or empty.
struct Detections {
  std::vector<ImageCorners> images;
  const ImageCorners* find(const std::string& image) const;
};

/// Width and height of pictures [px].
struct ImageSize {
  int width = 0, height = 0;
  double pixels() const { return static_cast<double>(width) * height; }
  bool operator==(const ImageSize&) const = default;
};
constexpr double kMostPixels = 2e8;  ///< larger pictures are not read: no camera takes them, and they fill the memory

/// Reads detections.csv. Images are named as imageName() does.
/// @throws FileError with the line: not a number, a corner that the target does not have (say which tags it has), the same corner of a
/// picture twice, a sigma that is not positive, a corner that lies outside of its picture by more than 1 % of the picture's side: it was
/// taken from pictures of another size, or is no corner. Columns beyond the contract's are passed over.
/// @param also_in_view  a second target (a reference) whose corners the file may hold too: they stand beside the target's. nullptr: none.
/// @param size          of the pictures; nothing: not known, and every corner within 1e6 px may be one.
Detections readDetections(const std::filesystem::path& file, const Target& target, const Target* also_in_view = nullptr,
                          const std::optional<ImageSize>& size = std::nullopt);
/// The sigma column is written only where some corner states one.
std::string detectionsCsv(const Detections& detections);

}  // namespace poecal
