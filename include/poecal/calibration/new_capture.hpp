// A capture folder to fill in: every file is there, and says what belongs into it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// What is known before the first picture is taken.
struct NewCapture {
  std::filesystem::path folder;
  std::filesystem::path robot;        ///< robot.yaml or a URDF
  std::string base_link, tip_link;    ///< of a URDF; empty: its root, its only leaf
  std::filesystem::path target;       ///< target.yaml
  std::filesystem::path camera = {};  ///< camera.yaml; empty: the lens is to be found from pictures of a board
  std::filesystem::path board = {};   ///< target.yaml of that board; empty: to be filled in
  Setup setup = Setup::kEyeToHand;
};

/// Writes capture.yaml, samples.csv with its header and without rows, copies of what is named, and the folders images/ and, without a
/// camera, intrinsics/. What each key and column means stands beside it as a comment.
/// @return the files that were written.
/// @throws InvalidArgument where the folder holds something already, or a URDF has several leaves and none is named; FileError as the
/// readers of what is named. Nothing is written then.
std::vector<std::filesystem::path> createCapture(const NewCapture& capture);

}  // namespace poecal
