// The tag families of libapriltag and the marker dictionaries of OpenCV, by the names that target.yaml uses.
#pragma once

#include <memory>
#include <string>

#include <opencv2/aruco/dictionary.hpp>

struct apriltag_family;

namespace poecal {

/// A family's codes and layout, given back to libapriltag at the end.
using TagFamily = std::unique_ptr<apriltag_family, void (*)(apriltag_family*)>;

/// @throws InvalidArgument for an unknown family.
TagFamily makeTagFamily(const std::string& name);

/// Reading errors that a family's codes allow to be corrected without taking clutter for tags (and without tables of gigabytes).
/// @throws InvalidArgument for an unknown family.
int correctableBits(const std::string& name);

/// @throws InvalidArgument for an unknown dictionary.
cv::Ptr<cv::aruco::Dictionary> makeMarkerDictionary(const std::string& name);

}  // namespace poecal
