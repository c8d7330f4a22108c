// Pictures -> corners, for every kind of target.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/capture/detections.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

struct DetectOptions {
  int jobs = 0;                 ///< pictures at a time; 0: one per core
  double quad_decimate = 2.0;   ///< AprilTag looks for quads in a picture this much smaller; edges are refined in the full one
  int expected_width = 0;       ///< 0: any size
  int expected_height = 0;
  void validate() const;
};

/// What a picture had to say besides its corners.
struct PictureNote {
  std::string image;
  std::string message;  ///< one sentence: unreadable, another size, no tag, tag 12 is not the target's, tag 7 seen twice
  bool failed = false;  ///< no corners came from this picture
};

struct DetectResult {
  Detections detections;            ///< one entry per picture, in the order given; empty corners where it failed
  std::vector<PictureNote> notes;   ///< in the order of the pictures
  int width = 0, height = 0;        ///< of the pictures
};

/// Corners of `target` in each of `images` (relative to `folder`). Memory does not grow with the number of pictures, and the result
/// does not depend on options.jobs.
///
/// A target seen twice in one picture (a tag id seen twice) gives no corners for that id. A picture that fails alone is a note.
/// @throws InvalidArgument for an unknown family or dictionary.
DetectResult detect(const std::filesystem::path& folder, const std::vector<std::string>& images, const Target& target, const DetectOptions& options);

/// Names that `family` may have, for messages.
std::vector<std::string> knownFamilies();

/// Pictures of a folder (png, jpg, jpeg, tif, tiff, bmp), sorted by name.
std::vector<std::string> listPictures(const std::filesystem::path& folder);

}  // namespace poecal
