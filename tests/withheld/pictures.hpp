// Pictures of a cell's tag, drawn by tracing rays: for cases in which poecal has to find the corners itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "withheld/cell.hpp"

namespace withheld {

/// How a camera renders what it sees. Grey levels of 255.
struct Look {
  double dark = 30.0, bright = 215.0;  ///< of the tag's ink and paper
  double blur = 0.7;                   ///< 1 sigma of the lens' spot, before the pixels sample it [px]
  double noise = 2.0;                  ///< 1 sigma, new in every pixel and picture
  std::uint64_t seed = 0;              ///< of background and noise
};

/// Writes the picture of a shot as a PNG.
///
/// Every pixel is the mean over its area of
///
///   spot(blur) * I(p),   I(p) = ink or paper of the tag36h11 tag where the ray through p meets it, else the background,
///
/// and noise, rounded to 8 bits. Rows are exposed one after another where the state has a line_time.
/// @param cell  of one tag, whose corners stay in a plane in all the flaws; no flaw may change pixels after the lens (outward, warp)
/// @throws std::invalid_argument for any other; std::runtime_error where the file cannot be written
void drawPicture(const Cell& cell, const Shot& shot, const std::vector<Flaw>& flaws, const Look& look, const std::filesystem::path& file);

}  // namespace withheld
