// Rows of a capture without what no component of the noise but the white one lets them say together.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/noise.hpp"

namespace poecal {

/// The rows of each pose turned by an orthogonal Q that begins with the span of what is not white in its noise, C = theta_0 I + sum_i
/// theta_i Z_i Z_i'. Beyond that span the noise is white: of those rows, however many corners there are, sums of squares are all that is
/// needed, and they do not hang on the variances. Where no component is white Q is the identity.
struct CondensedRows {
  /// @param extra  columns beside those of the base model.
  CondensedRows(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::MatrixXd& extra);

  /// One pose's rows in the span.
  struct Pose {
    int begin = 0, size = 0;
    std::vector<Eigen::Index> width;  ///< columns of each component; the white one has none
    Eigen::MatrixXd Z;                ///< Q' Z_i, side by side
  };

  std::vector<Pose> poses;
  Eigen::MatrixXd Xr;                ///< Q' [X r] in the span, columns of the base model, `extra`, the residual
  std::optional<std::size_t> white;  ///< number of the white component
  double beyond = 0.0;               ///< number of rows beyond the spans
  Eigen::MatrixXd squares;           ///< [X r]' [X r] of them

  Eigen::Index columns() const { return Xr.cols() - 1; }
};

/// Some poses at one set of variances.
struct WhitenedPoses {
  std::size_t begin = 0, end = 0;  ///< poses
  int row = 0;                     ///< where they begin in the condensed rows
  std::vector<Eigen::MatrixXd> L;  ///< Cholesky factor of each pose's C, its lower half
  Eigen::MatrixXd Xr;              ///< L^-1 Q' [X r]
};

/// Calls `visit` for all poses, some at a time, in their order. @param theta  variances of the components, and perhaps of others after
/// them.
/// @throws InsufficientData where a pose's C is singular.
void forWhitenedPoses(const CondensedRows& rows, const Eigen::VectorXd& theta, const std::function<void(const WhitenedPoses&)>& visit);

}  // namespace poecal
