// The cell, the poses and the columns of a case, before anything is wrong with them.
#pragma once

#include "withheld/case.hpp"

namespace withheld {

/// What a case must have for its effect to be possible.
struct Wishes {
  std::string family;  ///< of the arm; empty: any
  bool stamp = false, dir = false, dq = false, several_tags = false;
  bool masses = false;    ///< the arm's masses are told
  std::size_t shots = 0;  ///< how many; 0: 40 to 250
  bool in_hand = false;   ///< the camera is on the flange
  bool bare = false;      ///< columns stamp and dir alone, and every joint comes straight from the pose before
  bool pictures = false;  ///< of one tag, 40 to 80 of them, a quarter of the pixels: they are drawn and searched
};

/// Arm, camera, tags, poses and columns by chance; sets told, actual, columns, shots, noise.
void drawSetting(Case& made, const Wishes& wishes, Chance& chance);

}  // namespace withheld
