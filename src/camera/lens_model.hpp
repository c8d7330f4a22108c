// The table of lens models. A model is a file lens_NAME.cpp, its value in DistortionModel and kDistortionModels, and its two lines here and
// in lens_model.cpp.
#pragma once

#include <span>

#include "camera/distortion.hpp"
#include "poecal/camera/camera.hpp"

namespace poecal {

struct Coefficient {
  const char* name;
  /// Beyond what a real lens has: a coefficient known no better than this is not known.
  double plausible;
};

struct LensModel {
  DistortionModel model;
  const char* name;                           ///< in camera.yaml
  std::span<const Coefficient> coefficients;  ///< in the order of the vector `k`; the first two are radial and grow with the radius
  /// A point in front of the lens -> the plane of the pixels, see distortion.hpp.
  std::optional<Eigen::Vector2d> (*distort)(const Eigen::VectorXd& k, const Eigen::Vector3d& p_camera, DistortionJacobians* jacobians);
  std::optional<Eigen::Vector3d> (*rayOfRadius)(const Eigen::VectorXd& k, const Eigen::Vector2d& unit, double radius);
};

extern const LensModel kPlumbBobLens, kRationalPolynomialLens, kEquidistantLens, kThinPrismLens;

const LensModel& lensModel(DistortionModel model);

}  // namespace poecal
