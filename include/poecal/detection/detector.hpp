// Pictures -> corners, for every kind of target.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "poecal/camera/camera.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

class KnownCorners;

struct DetectOptions {
  int jobs = 0;                  ///< pictures at a time; 0: one per core
  double quad_decimate = 2.0;    ///< AprilTag looks for quads in a picture this much smaller; edges are refined in the full one
  bool refine = true;            ///< fit corners to the grey values of the whole tag, or of the squares about them on a board
  std::optional<Camera> camera;  ///< whose lens bends the edges that are fitted; nothing: edges are straight
  int expected_width = 0;        ///< 0: the size of the first picture that can be read
  int expected_height = 0;
  std::vector<int> other_tags;     ///< ids that are in view for another purpose (a reference) and need no note
  ProgressFunction progress = {};  ///< told of each picture; may be empty
  void validate() const;           ///< @throws InvalidArgument with the field's name and value.
};

/// A remark about one picture.
struct PictureNote {
  std::string image;
  std::string message;  ///< one sentence: unreadable, another size, no tag, tag 12 is not the target's, tag 7 seen twice
  bool failed = false;  ///< no corners came from this picture

  std::string text() const { return image + ": " + message; }
};

/// "image: message" of each note.
std::vector<std::string> texts(const std::vector<PictureNote>& notes);

struct DetectResult {
  Detections detections;           ///< one entry per picture, in the order given, with its look; empty corners where it failed
  std::vector<PictureNote> notes;  ///< in the order of the pictures
  int width = 0, height = 0;       ///< of the pictures
};

/// Corners of `target` in each of `images` (relative to `folder`). Memory does not grow with the number of pictures, and the result
/// does not depend on options.jobs.
///
/// Tags: a quick pass with quad_decimate, and where a tag of the target is missing a thorough one in the full picture.
/// Their corners are then fitted to the picture (options.refine). Each states its sigma: the fit's, or that of AprilTag's own corners; what
/// the fits say of blur, noise and growth is the picture's look, by the median of its tags.
/// Chessboards and ChArUco boards: each corner is fitted to the half squares about it (options.refine) and states its sigma; one that
/// cannot be fitted stays that of a sub-pixel window, and states five times the others' sigma or more. Without options.refine none is
/// stated. The only tag of an aprilgrid in a picture is left out where it cannot be fitted: black squares at its corners pull them off by
/// pixels. An aprilgrid's tags have a black border of one or two cells: as the target states it, or whichever the picture shows. A tag id
/// seen twice in one picture gives no corners for that id. A picture that fails alone is a note. Where nothing was seen at all but tags of
/// another family or markers of another dictionary are there, the last note says so. A chessboard with an odd and an even number of corners
/// starts where the square between corners 0, 1, cols and cols + 1 is dark; others look the same after half a turn and start where OpenCV
/// starts. Where only a board of another size is seen, the note names it; a ChArUco board whose markers lie elsewhere than stated gives no
/// corners.
/// @param known  corners found before: a picture of the same bytes with the same detectionKey() is not searched again, and what is found
/// joins them as each picture is finished. The result is the same with and without.
/// @throws InvalidArgument for an unknown family or dictionary, or a target of single points, which pictures do not show. FileError where
/// nothing was seen and the pictures show the target's tags or markers mirrored.
DetectResult detect(const std::filesystem::path& folder, const std::vector<std::string>& images, const Target& target,
                    const DetectOptions& options, KnownCorners* known = nullptr);

/// Names that `family` may have, for messages.
std::vector<std::string> knownFamilies();

/// Pictures of a folder (png, jpg, jpeg, tif, tiff, bmp), sorted by name. @throws FileError where the folder cannot be read.
std::vector<std::string> listPictures(const std::filesystem::path& folder);

}  // namespace poecal
