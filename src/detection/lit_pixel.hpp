// A pixel of a blurred tag in uneven light, as a row of the equations that fit how the tag looks.
#pragma once

#include <Eigen/Core>

#include "detection/tag_appearance.hpp"

namespace poecal {

/// Grey value of black and its slopes across the part of the picture, then contrast and its slopes.
using Light = Eigen::Matrix<double, 6, 1>;

/// Blur, kurtosis, growth, and the light.
constexpr int kLitParameters = 9;

/// What a fit asks of a pixel beside its row.
struct LitPixel {
  double contrast = 0.0;  ///< of white to black there
  double residual = 0.0;  ///< grey value less black + contrast times whiteness
};

/// Fills the columns of a pixel's row that do not depend on how the pattern moves: from kFirst on the derivatives by blur, kurtosis,
/// growth, the three of black and the three of contrast, then the residual.
/// @param pixel  its `unit` is the place within the part, -1 to 1 along both axes.
template <int kFirst, typename Pixel, typename RowVector>
LitPixel fillLit(const Pixel& pixel, const Whiteness& white, const Light& light, RowVector& row) {
  const Eigen::Vector3d shading(1.0, pixel.unit.x(), pixel.unit.y());
  const double black = shading.dot(light.head<3>()), contrast = shading.dot(light.tail<3>());
  row(kFirst) = contrast * white.J_value_blur;
  row(kFirst + 1) = contrast * white.J_value_kurtosis;
  row(kFirst + 2) = contrast * white.J_value_growth;
  row.template segment<3>(kFirst + 3) = shading;
  row.template segment<3>(kFirst + 6) = white.value * shading;
  const double residual = pixel.grey - black - contrast * white.value;
  row(kFirst + kLitParameters) = residual;
  return {contrast, residual};
}

}  // namespace poecal
