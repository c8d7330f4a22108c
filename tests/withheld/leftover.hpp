// How much of an effect is left once the geometry of the cell has been identified.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "withheld/cell.hpp"

namespace withheld {

/// What makes corners scatter. Wild rows are not part of it.
struct Noise {
  double corner = 0.1;                         ///< of each coordinate of each corner [px]
  double common = 0.0;                         ///< of each tag as a whole [px]
  double repeatability = 0.0;                  ///< of each turning joint at each pose [rad]; sliding ones 0.3 m/rad of it
  std::map<std::size_t, double> scatter = {};  ///< joints (from 0) that come to rest at random beside that, and how far [rad, m]
};

/// Joint repeatability in the joint's unit.
double repeatabilityOf(const Joint& joint, const Noise& noise);

/// What an instrument reports of the shots of a cell with some flaws in it, one shot below the other.
using Observe = std::function<Eigen::VectorXd(const Cell&, const std::vector<Shot>&, const std::vector<Flaw>&)>;
/// The instrument of most cases: pixels of all corners.
Eigen::VectorXd observeCorners(const Cell& cell, const std::vector<Shot>& shots, const std::vector<Flaw>& flaws);

/// Derivatives of all observations by what identification can change: six numbers for the frame of every joint, six for the camera, six for
/// the target on the flange; with lens_too also focal length (relative), principal point, k1 and k2, the last five columns.
Eigen::MatrixXd geometryColumns(const Cell& cell, const std::vector<Shot>& shots, bool lens_too, const Observe& observe = observeCorners);
/// Turn, then shift, by one of its six numbers.
Frame smallMotion(int number, double amount);
constexpr Eigen::Index kLensColumns = 5;

/// What each scalable parameter of a flaw does to the observations at its usual size.
Eigen::MatrixXd flawColumns(const Cell& cell, const std::vector<Shot>& shots, const Flaw& flaw, const Observe& observe = observeCorners);

/// Lower Cholesky factor of the covariance of each shot's corners.
std::vector<Eigen::MatrixXd> noiseFactors(const Cell& cell, const std::vector<Shot>& shots, const Noise& noise);
/// Columns of observations, each shot's part divided by its factor.
Eigen::MatrixXd whiten(Eigen::MatrixXd columns, const std::vector<Eigen::MatrixXd>& factors);

/// Factors that bring columns to length 1; 0 for those that are rounding errors of the longest.
Eigen::VectorXd columnScales(const Eigen::MatrixXd& columns);
constexpr double kRankTolerance = 1e-7;  ///< of columns of length 1

/// Least squares on columns of which some may be the sum of others: the smallest of all answers. (Eigen's QR with pivots solves with all
/// its pivots, whatever threshold its rank has, and fits rounding errors.)
struct Solution {
  Eigen::VectorXd x;
  Eigen::Index rank = 0;
};
Solution solveSmallest(const Eigen::MatrixXd& columns, const Eigen::VectorXd& right);

/// Orthonormal columns that span these, less what is shorter than `tolerance` of columns of length 1.
Eigen::MatrixXd spanOf(const Eigen::MatrixXd& columns, double tolerance);
constexpr double kLeftTolerance = 1e-5;  ///< of columns from which geometry is taken away

/// The observations of a capture, to first order, less all that errors of geometry can do to them (geometryColumns); the span of those is
/// found by QR with column pivoting.
///
///   S(effect) = | (I - Q Q^T) W effect |,  W^T W = inverse covariance of the noise
///
/// is the square root of the chi-square that the effect leaves after identification.
class Leftover {
 public:
  Leftover(const Cell& cell, const std::vector<Shot>& shots, const Noise& noise, bool lens_too);
  /// Of any instrument. @param factors  see noiseFactors
  Leftover(const Cell& cell, const std::vector<Shot>& shots, std::vector<Eigen::MatrixXd> factors, bool lens_too, Observe observe);

  /// Observations with the flaws minus those without, whitened, less what geometry explains.
  Eigen::VectorXd left(const std::vector<Flaw>& flaws) const;
  double size(const Flaw& flaw) const { return left({flaw}).norm(); }
  /// What is left of each scalable parameter of a flaw, by its usual size.
  Eigen::MatrixXd columns(const Flaw& flaw) const;
  /// What is left of `effect` (as left() gives it) when these columns may explain it as well.
  static Eigen::VectorXd besides(const Eigen::VectorXd& effect, const Eigen::MatrixXd& columns);

  /// Any difference of observations, whitened, less what geometry explains.
  Eigen::MatrixXd withoutGeometry(const Eigen::MatrixXd& observed) const;
  Eigen::Index rank() const { return span_.cols(); }

 private:
  const Cell& cell_;
  const std::vector<Shot>& shots_;
  Observe observe_;
  Eigen::VectorXd still_;  ///< observations without flaws
  std::vector<Eigen::MatrixXd> factors_;
  Eigen::MatrixXd span_;  ///< orthonormal columns
};

}  // namespace withheld
