// scene.yaml: a cell whose truth is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "poecal/capture/picture_look.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/effects/effect.hpp"

namespace poecal {

/// How pictures are drawn.
struct ImageOptions {
  double blur = 0.7;                   ///< standard deviation of the Gaussian point spread [px]
  double noise = 2.0;                  ///< standard deviation of a pixel's noise [grey levels of 255]
  std::string background = "clutter";  ///< "clutter" or "plain"
  void validate() const;               ///< @throws InvalidArgument with the field's name and value.
};

struct Scene {
  std::filesystem::path file;
  std::string name;
  Arm nominal;                       ///< what the capture is told
  std::filesystem::path robot_file;  ///< robot.yaml or URDF; copied into the capture
  std::string base_link, tip_link;   ///< URDF only
  Arm actual;                        ///< the truth: nominal with `errors`, or the file `actual:`
  Camera camera;                     ///< the true lens
  Camera stated_camera;              ///< what the capture is told
  Target target;                     ///< the true target
  Target stated_target;              ///< what the capture is told
  Registration registration;
  std::vector<AppliedEffect> effects;  ///< further flaws of the cell, of which the capture is not told
  int count = 60;                      ///< poses; ignored where samples come from a file
  std::uint64_t seed = 1;              ///< of the samples, the pictures and the noise
  int repeats = 1;                     ///< shots per pose
  std::filesystem::path samples_file;  ///< empty: drawn
  std::optional<ImageOptions> image;   ///< pictures...
  std::vector<PictureLook> looks;      ///< ...with blur and noise of these in turn instead of image's; empty: all as `image`
  std::optional<double> corner_sigma;  ///< ...or corners without pictures [px]
  std::optional<Target> board;         ///< intrinsics pictures of this board are added (key `intrinsics: {target: board.yaml, count: 15}`)
  int board_count = 0;
};

/// How the `index`-th picture (or intrinsics picture) of a scene with pictures is drawn: blur and noise of its looks in order, from the
/// first again when they are used up.
ImageOptions imageOptions(const Scene& scene, std::size_t index);

/// Reads scene.yaml (format poecal-scene/1); calib_data/FORMATS.md has all keys. Among them
///   setup: eye_in_hand (default eye_to_hand); base_link, tip_link beside a URDF robot; stated_target: other.yaml;
///   intrinsics: {target: board.yaml, count: 15}: pictures of a board for the capture's intrinsics folder, and no camera.yaml in the
///   capture; registration: with T_camera_flange and T_base_target where setup is eye_in_hand.
/// `samples: {count, seed, repeats}` or `samples: {file, seed}`; each has the default of Scene. Without `image:` and `corners:` pictures
/// are drawn. `errors: {seed, position, rotation}` turns every axis about two directions across it and shifts it along them (revolute), 1
/// sigma each per joint.
/// `image: {like: FILE, background: clutter}` takes blur and noise of each picture from a table as detect writes it
/// (detections-pictures.csv); growth is not drawn.
/// `effects:` as makeEffect takes them; those that move single points or pixels need `corners:`, pictures cannot be drawn of them.
/// @throws FileError with the line.
Scene readScene(const std::filesystem::path& file);

}  // namespace poecal
