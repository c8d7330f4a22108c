// Draws a target as a camera sees it: supersampled through the lens, blurred, noisy, before clutter.
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "poecal/camera/camera.hpp"
#include "poecal/simulation/scene.hpp"
#include "poecal/target/target.hpp"

namespace cv {
class Mat;
}

namespace poecal {

/// An 8-bit grey picture of `target` at T_camera_target.
///
/// Each pixel is the mean of supersample^2 rays over its square (the pixel (u, v) covers u-0.5..u+0.5), so edges carry their sub-pixel
/// place; then Gaussian blur, noise and rounding. @param seed, stream  of the background and the noise.
cv::Mat renderTarget(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target, const ImageOptions& options,
                     std::uint64_t seed, std::uint64_t stream, int supersample = 8);

}  // namespace poecal
