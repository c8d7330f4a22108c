// The corners of a whole capture: its target and, where it has one, its reference.
#pragma once

#include "poecal/capture/capture.hpp"
#include "poecal/detection/detector.hpp"

namespace poecal {

/// detect() for every sample's picture. Corners of the reference stand beside the target's; readCapture makes sure that their names differ.
/// A picture's look is that of the target's tags, and of the reference's where none of those was fitted.
/// Where the capture has a camera, pictures of another size fail. Notes that only concern the reference begin with "reference: ".
/// @param options  expected sizes and other_tags are filled in from the capture.
/// @param known  as detect() takes them.
/// @throws as detect().
DetectResult detectCapture(const Capture& capture, DetectOptions options, KnownCorners* known = nullptr);

/// Gives a camera of 0 x 0 pixels (readCameraOfPictures) the size of the capture's first picture that can be read.
/// @throws FileError where there is none.
void takeSizeFromPictures(Capture& capture);

}  // namespace poecal
