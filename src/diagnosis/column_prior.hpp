// What is believed of the columns of a linear model before its rows are looked at.
#pragma once

#include <Eigen/Core>

#include "diagnosis/capture_rows.hpp"

namespace poecal {

/// Prior of the columns X: b + offset ~ N(0, inverse of `precision`); zero rows of precision: nothing is known.
struct ColumnPrior {
  Eigen::VectorXd offset;
  Eigen::MatrixXd precision;
  double log_determinant = 0.0;  ///< of the part of the precision that is not zero

  static ColumnPrior none(Eigen::Index columns);
  /// Independent columns.
  static ColumnPrior independent(const Eigen::VectorXd& sigma, const Eigen::VectorXd& offset);
  ColumnPrior joinedWith(const ColumnPrior& other) const;
  /// With further rows that tell of these columns alone, of information S and score u at b = 0. Precise in every direction.
  /// @param log_mass  gets log of the integral of prior(b) exp(u'b - b'Sb/2).
  ColumnPrior informedBy(const Eigen::MatrixXd& S, const Eigen::VectorXd& u, double& log_mass) const;
};

/// The base model's prior: twists by the tolerances widened by `tolerance`, stated intrinsics, the far transform by kFarPosition.
ColumnPrior basePrior(const MeasuredCell& measured, const ModelState& state, double tolerance);

}  // namespace poecal
