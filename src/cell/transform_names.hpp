// What the two transforms of a registration are called, in files, in messages and among the parameters of a fit.
#pragma once

#include <string>

#include "poecal/cell/cell.hpp"

namespace poecal {

/// "T_camera_base", or of a camera on the flange "T_camera_flange".
inline std::string nearName(const Registration& registration) { return std::string("T_camera_") + registration.nearFrame(); }

/// "T_flange_target", or of a camera on the flange "T_base_target".
inline std::string farName(const Registration& registration) { return std::string("T_") + registration.farFrame() + "_target"; }

}  // namespace poecal
