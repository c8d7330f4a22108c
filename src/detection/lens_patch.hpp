// The lens over one small part of a picture, where straight lines of a plane are made straight again.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "poecal/camera/camera.hpp"

namespace poecal {

/// px_straight = px + d(px): the pixel that a pinhole camera with the same matrix would have given. d is a polynomial of fifth degree,
/// which one step of Newton's method on the camera's own projection makes exact.
class LensPatch {
 public:
  /// No lens: px_straight = px.
  LensPatch() = default;
  /// Fits d to the camera's own inverse over the box from `low` to `high` [px].
  /// @return nothing where some ray of the box is 80 degrees from the axis or more, or does not exist, or where the polynomial leaves more
  /// than 0.2 px, as where a lens nearly folds.
  static std::optional<LensPatch> of(const Camera& camera, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

  struct Straight {
    Eigen::Vector2d px = Eigen::Vector2d::Zero();
    Eigen::Matrix2d J_straight_px = Eigen::Matrix2d::Identity();
  };
  /// By the polynomial alone: within 0.2 px, mostly 1e-3.
  Straight straighten(const Eigen::Vector2d& px) const;
  /// Within 3e-3 px of the camera's inverse at the rim of a lens that the polynomial hardly follows, else far better.
  Straight straightenExactly(const Eigen::Vector2d& px) const;
  /// The same pixel from what straighten() gave for it.
  Eigen::Vector2d exactly(const Eigen::Vector2d& px, const Straight& straight) const;
  /// The pixel whose straight one is `px_straight`, as the camera projects; not a number where it does not.
  Eigen::Vector2d bend(const Eigen::Vector2d& px_straight) const;

 private:
  static constexpr int kTerms = 21;
  /// Products of powers of two numbers up to the fifth degree, and their derivatives by each.
  struct Terms {
    Eigen::Matrix<double, kTerms, 1> values;
    Eigen::Matrix<double, kTerms, 2> slopes;
  };

  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
  double scale_ = 1.0;  ///< [px]
  std::optional<Camera> camera_;
  Eigen::Matrix<double, 2, kTerms> coefficients_ = Eigen::Matrix<double, 2, kTerms>::Zero();

  static Terms terms(const Eigen::Vector2d& x);
};

}  // namespace poecal
