// How much of what single points are off is the measuring's own, as far as the capture can tell it from what a model leaves.
#pragma once

#include "diagnosis/evidence.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

/// Mean squares of a corner's length [px^2], or of a position's [m^2].
struct MeasurementNoise {
  double least = 0.0;   ///< what is the measuring's, whatever the arm does
  double most = 0.0;    ///< with all that could be: what the arm comes back by, and what no column explains
  double random = 0.0;  ///< with joints that move at random by themselves besides: no model foretells what they do
  double chance = 0.0;  ///< 1 sigma, as a share of `least`, by which so many squares differ from their mean and by which that is known
  NoiseSource source = NoiseSource::kEstimated;
};

/// The noise of a capture beside all that is in a linearisation.
///
/// Pictures: `least` is the corners' component of the noise, or, where structure got into that, what corners leave beside a free pose of
/// their target,
///
///   sum |r - H H^+ r|^2 / sum (rows - 6),
///
/// what a whole tag shares where tags in one picture or repeats tell it, and what rounding takes from the readings; `most` has the joints'
/// repeatability and that share of the tag besides. Joints that move at random by themselves are no noise of the measuring. Poses: `least`
/// is what repeats differ by, or the stated deviations, and that rounding; without either of them it is that alone, `most` what the
/// components of the noise come to, and the source is kUnknown.
/// @param stated  whether the poses' deviations were stated.
MeasurementNoise measurementNoise(const MeasuredCell& measured, const Linearised& linear, bool stated);

/// Whether some picture shows more than one tag.
bool severalTags(const CaptureRows& rows);

}  // namespace poecal
