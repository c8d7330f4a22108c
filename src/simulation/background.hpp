// What is behind the target.
#pragma once

#include <string>

#include "poecal/core/random.hpp"

namespace cv {
class Mat;
}

namespace poecal {

/// Grey levels of a background, CV_32F. "plain": one grey; "clutter": shading with rectangles, lines and blobs that no detector takes for
/// tags.
/// @throws InvalidArgument for another name.
cv::Mat drawBackground(const std::string& name, int width, int height, Rng& rng);

}  // namespace poecal
