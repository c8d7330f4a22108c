// Draws a target as a camera sees it: through the lens, blurred, gathered by pixels, noisy, before clutter.
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
/// The lens blurs (Gaussian), then each pixel gathers the mean over its square (the pixel (u, v) covers u-0.5..u+0.5); then noise and
/// rounding. Edges are drawn by the areas that they cut off, not by samples, so that corners lie within 0.002 px of their projection.
/// @param seed, stream  of the background and the noise.
cv::Mat renderTarget(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target, const ImageOptions& options,
                     std::uint64_t seed, std::uint64_t stream);

}  // namespace poecal
