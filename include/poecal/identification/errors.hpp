// How far a model is from what was measured, in pixels, millimetres and milliradians.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"

namespace poecal {

struct SampleRows;

/// Mean, median, root mean square, 95 % quantile and maximum of lengths.
struct LengthSummary {
  double mean = 0.0, median = 0.0, rms = 0.0, p95 = 0.0, max = 0.0;
};
LengthSummary summarise(const std::vector<double>& lengths);

/// Squares of lengths of one pose, all its shots together.
struct PoseSquares {
  double squares = 0.0;  ///< sum of squared lengths, [px^2] or [m^2]
  double points = 0.0;   ///< number of lengths
};
/// 95 % interval of sqrt(sum of squares / sum of points): percentiles over resampled poses, always the same for the same poses. (0, 0)
/// where there are no points.
std::pair<double, double> rmsInterval(const std::vector<PoseSquares>& poses);

/// Errors of a set of poses.
struct ErrorSummary {
  int poses = 0;
  int corners = 0;
  LengthSummary px;  ///< length of a corner's residual [px]; zero for poses
  /// Of the flange, free of the noise of corners (see expectedFlangeErrors()); of poses of an instrument the distance of the measured
  /// point, its noise included [m].
  LengthSummary position;
  LengthSummary rotation;  ///< likewise [rad]; zero where only positions were measured
};

/// What one picture's corners say of the error e = (rotation in base; position) of the modelled flange [rad; m]:
/// information = J^T J / noise^2, pull = J^T r / noise^2 with r the residuals in stated sigmas, noise their standard deviation and
/// J = d(model)/d(e).
struct FlangeEvidence {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
};
/// Distance and angle of a flange from where it is.
struct FlangeError {
  double position = 0.0, rotation = 0.0;  ///< [m], [rad]
};
/// A single tag shows its depth and its tilts ten times worse than its place in the picture, so that the pose which it gives is mostly
/// noise. The errors of all poses are therefore taken as drawn from N(0, diag(v_r I, v_p I)), whose variances are estimated from all of
/// them (maximum marginal likelihood by MacKay's fixed point), and each pose's is sqrt(E |e|^2), E |e|^2 = |mean|^2 + trace(covariance)
/// given its corners. Where the estimate is 0 the variances are what so many poses could not have told from 0.
std::vector<FlangeError> expectedFlangeErrors(const std::vector<FlangeEvidence>& evidence);

/// Errors of one observation.
struct RowErrors {
  std::size_t index = 0;          ///< of the observation
  double whitened_squares = 0.0;  ///< residuals in stated sigmas
  std::vector<double> lengths;    ///< of the corners that can be projected [px]; of poses the distance [m]
  FlangeEvidence evidence;        ///< corners only
  FlangeError measured;           ///< poses only
};

/// Errors of single observations, collected over folds and summarised once.
class ErrorCollector {
 public:
  /// @param noise  standard deviation of corners in their stated sigmas.
  explicit ErrorCollector(double noise = 1.0) : noise_(noise) {}
  void add(const Cell& cell, std::size_t index, const Observation& observation);
  /// The same where the model has the target elsewhere than the cell, and knows more of what was measured.
  /// @param r  what was measured less what the model expects, in stated sigmas: 2 numbers a corner, or 6 or 3 a pose.
  void add(const Cell& cell, std::size_t index, const Observation& observation, const Eigen::Isometry3d& T_camera_target,
           const Eigen::VectorXd& r);
  /// Of the observations whose index counts. @param counts  empty: all do.
  ErrorSummary summary(const std::function<bool(std::size_t)>& counts = {}) const;
  /// In the order added.
  const std::vector<RowErrors>& rows() const { return rows_; }

 private:
  void addRow(const Cell& cell, std::size_t index, const Observation& observation, const Eigen::Isometry3d& T_camera_target,
              const SampleRows& rows, const Eigen::VectorXd& r);

  double noise_;
  bool poses_ = false;     ///< of an instrument
  bool rotations_ = true;  ///< whether they have one
  std::vector<RowErrors> rows_;
};

}  // namespace poecal
