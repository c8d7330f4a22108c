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
  Straight straighten(const Eigen::Vector2d& px) const { return row(px.y()).straighten(px.x()); }

  /// Along one row of pixels, where d is a polynomial in x alone: a quarter of the time.
  class Row {
   public:
    /// straighten() without its derivative: a third of the time again.
    Eigen::Vector2d straightPixel(double x) const {
      Eigen::Vector2d px(x, y_);
      if (!patch_->camera_) return px;
      const double a = (x - patch_->centre_.x()) / patch_->scale_;
      Eigen::Vector2d value = values_.col(kDegree);
      for (Eigen::Index i = kDegree - 1; i >= 0; --i) value = value * a + values_.col(i);
      return px + value;
    }
    Straight straighten(double x) const;
    Straight straightenExactly(double x) const;

   private:
    friend class LensPatch;
    const LensPatch* patch_ = nullptr;
    double y_ = 0.0;
    /// Of d and of its derivative by y, column i for the power i of x.
    Eigen::Matrix<double, 2, 6> values_, slopes_;
  };
  Row row(double y) const;
  /// Within 3e-3 px of the camera's inverse at the rim of a lens that the polynomial hardly follows, else far better.
  Straight straightenExactly(const Eigen::Vector2d& px) const { return row(px.y()).straightenExactly(px.x()); }
  /// The pixel whose straight one is `px_straight`, as the camera projects; not a number where it does not.
  Eigen::Vector2d bend(const Eigen::Vector2d& px_straight) const;

 private:
  static constexpr int kDegree = 5, kTerms = 21;

  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
  double scale_ = 1.0;  ///< [px]
  std::optional<Camera> camera_;
  bool needs_newton_ = false;  ///< the polynomial alone is not as good as anybody could wish
  /// Of x^i y^j, i + j <= kDegree, j running faster.
  Eigen::Matrix<double, 2, kTerms> coefficients_ = Eigen::Matrix<double, 2, kTerms>::Zero();

  static Eigen::Matrix<double, kTerms, 1> terms(const Eigen::Vector2d& x);
};

}  // namespace poecal
