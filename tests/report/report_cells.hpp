// Calibrations to report of, from memory.
#pragma once

#include "poecal/calibration/run_capture.hpp"

namespace poecal::test {

/// Names as a hostile file may have them: they end scripts, open elements, and turn lines.
inline constexpr const char* kHostileName = "</script><img src=x onerror=alert(1)>&amp;{{data}}\"'\xE2\x80\xA8.png";

/// Sixty pictures of one tag; joint 2 has play of 0.4 mrad either way. Arm, joints, pictures and a further column have hostile names.
const CalibrationRun& runWithBacklash();
/// The same cell without any effect.
const CalibrationRun& runWithout();
/// A curve at joint 3 that no effect has, and one picture whose corners belong elsewhere.
const CalibrationRun& runWithCurve();
/// Joint 2 comes to rest at random.
const CalibrationRun& runWithScatter();
/// runWithBacklash() as `identify` leaves it.
CalibrationRun identifiedOnly();
/// Poses of an instrument, with the same play.
const CalibrationRun& runOfPoses();

}  // namespace poecal::test
