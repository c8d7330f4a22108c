// How much of an effect is left once the geometry of the cell has been identified.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "withheld/cell.hpp"

namespace withheld {

/// What makes corners scatter. Wild rows are not part of it.
struct Noise {
  double corner = 0.1;         ///< of each coordinate of each corner [px]
  double common = 0.0;         ///< of each tag as a whole [px]
  double repeatability = 0.0;  ///< of each turning joint at each pose [rad]; sliding ones 0.3 m/rad of it
};

/// Joint repeatability in the joint's unit.
double repeatabilityOf(const Joint& joint, const Noise& noise);

/// The corners of a capture, to first order, less all that errors of geometry can do to them: six numbers for the frame of every joint, six
/// for the camera and six for the target on the flange; their span is found by QR with column pivoting.
///
///   S(effect) = | (I - Q Q^T) W effect |,  W^T W = inverse covariance of the noise
///
/// is the square root of the chi-square that the effect leaves after identification.
class Leftover {
 public:
  /// @param lens_too  focal length, principal point, k1 and k2 are identified as well.
  Leftover(const Cell& cell, const std::vector<Shot>& shots, const Noise& noise, bool lens_too);

  /// Corners with the flaws minus corners without, whitened, less what geometry explains.
  Eigen::VectorXd left(const std::vector<Flaw>& flaws) const;
  double size(const Flaw& flaw) const { return left({flaw}).norm(); }
  /// What is left of each scalable parameter of a flaw, by its usual size.
  Eigen::MatrixXd columns(const Flaw& flaw) const;
  /// What is left of `effect` (as left() gives it) when these columns may explain it as well.
  static Eigen::VectorXd besides(const Eigen::VectorXd& effect, const Eigen::MatrixXd& columns);

  Eigen::VectorXd whitened(const Eigen::VectorXd& pixels) const;
  Eigen::MatrixXd withoutGeometry(Eigen::MatrixXd whitened_columns) const;
  /// What one unit of each joint's error moves, whitened but not projected.
  const Eigen::MatrixXd& jointColumns() const { return joint_columns_; }
  const Eigen::VectorXd& still() const { return still_; }  ///< corners without flaws
  Eigen::Index rank() const { return span_.cols(); }

 private:
  const Cell& cell_;
  const std::vector<Shot>& shots_;
  Eigen::VectorXd still_;
  std::vector<Eigen::MatrixXd> factors_;  ///< lower Cholesky factor of each shot's covariance
  Eigen::MatrixXd joint_columns_;
  Eigen::MatrixXd span_;  ///< orthonormal columns
};

}  // namespace withheld
