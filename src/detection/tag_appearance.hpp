// How white a blurred picture of a tag is at one of its pixels, with derivatives.
#pragma once

#include <Eigen/Core>

#include "detection/tag_pattern.hpp"

namespace poecal {

/// Where a pixel looks at, and how the pattern's lines run past it in the picture.
struct TagView {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();     ///< [cells]
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< |d u / d px|, |d v / d px| [cells / px]
  Eigen::Vector2d width = Eigen::Vector2d::Zero();  ///< of a cell, 1 / slope [px / cell]
  double cosine = 0.0;                              ///< of the angle between the two gradients; 0: the cells are rectangles in the picture

  /// @param J_uv_px  derivative of the cell coordinates by the pixel [cells / px].
  TagView(const Eigen::Vector2d& uv, const Eigen::Matrix2d& J_uv_px);
};

/// What a lens, the pixel's square and filters in the camera make of a point, alike in every direction.
struct PointSpread {
  double blur = 0.9;      ///< standard deviation, positive [px]
  double kurtosis = 0.0;  ///< in excess of a Gaussian's: a square pixel or defocus have less than 0, a halo more
};

struct Whiteness {
  double value = 0.0;                                          ///< 0 black, 1 white
  Eigen::RowVector2d J_value_uv = Eigen::RowVector2d::Zero();  ///< [1 / cell], at a fixed slope and cosine
  double J_value_blur = 0.0;                                   ///< [1 / px]
  double J_value_growth = 0.0;                                 ///< [1 / px]
  double J_value_kurtosis = 0.0;
};

/// The pattern, its dark parts grown by `growth` over every edge, seen through `spread`:
///   value = w_0 + sum_i Delta_i S(a_i) + sum_j Delta_j S(b_j) + sum_ij d_ij S_2(a_i, b_j; cosine),
///   a_i = ((u - i) / slope_u - growth s_i) / blur,  b_j likewise with v,
/// over the lines i and j within reach: w_0 is the cell before the first of them, Delta the steps along the first row and column, d the
/// turns inside, s the side that each moves to. S is the normal distribution with the first term of Edgeworth's series,
///   S(a) = Phi(a) - kurtosis / 24 (a^3 - 3 a) phi(a),
/// and S_2 = S(a) S(b) + (Phi_2 - Phi Phi) with the bivariate normal distribution, by its series in the cosine up to the fourth power: 1e-3
/// at a cosine of 0.6, which a square has when seen at 60 degrees across its diagonal.
/// @param growth  [px], negative where light grows into dark.
Whiteness whiteness(const TagPattern& pattern, const TagView& view, const PointSpread& spread, double growth);

/// What lies about a pixel, along both directions of the cells: nothing but one grey, edges, or edges and something that is not known.
enum class Surroundings { kFlat, kEdges, kUnknown };
/// @param edge_reach     distance [px] within which edges count.
/// @param unknown_reach  distance [px] within which nothing unknown may be.
Surroundings surroundings(const TagPattern& pattern, const TagView& view, double edge_reach, double unknown_reach);

}  // namespace poecal
