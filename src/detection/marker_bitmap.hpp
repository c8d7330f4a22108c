// The black and white cells of one marker, upright.
#pragma once

#include <string>
#include <vector>

namespace poecal {

struct MarkerBitmap {
  int width = 0;            ///< cells a side, with whatever belongs to the marker outside its corners
  int corner_width = 0;     ///< cells between the corners, centred in `width`
  std::vector<bool> white;  ///< row by row from the top left

  bool isWhite(int column, int row) const { return white[static_cast<std::size_t>(row * width + column)]; }
};

/// A tag of libapriltag, as apriltag_to_image draws it, with a black border of `border_bits` cells (1: as the library has it).
/// @throws InvalidArgument for an unknown family or id, and a wider border of a family that is not mayHaveWideBorder().
MarkerBitmap tagBitmap(const std::string& family, int id, int border_bits = 1);
/// A marker of an OpenCV dictionary with a black border of one cell. @throws InvalidArgument for an unknown dictionary or id.
MarkerBitmap arucoBitmap(const std::string& dictionary, int id);

}  // namespace poecal
