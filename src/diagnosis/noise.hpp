// The noise of a capture as variance components, and the marginal likelihood of a linear model in that noise.
//
//   r = X b + e,   b ~ N(-b0, Lambda^-1),   e ~ N(0, C),   C = sum_i theta_i V_i, block-diagonal over the poses
//
// The components are estimated by restricted maximum likelihood (average information), not assumed: a wrong noise level is where false
// alarms come from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "diagnosis/capture_rows.hpp"
#include "diagnosis/column_prior.hpp"

namespace poecal {

/// A sliding joint's share of the common repeatability: 1e-6 m beside 1e-5 rad.
constexpr double kMetresPerRadian = 0.1;

/// V_i = Z_i Z_i^T of one component, for each pose (group): rows of the pose x width. Columns are what one draw of it moves.
struct NoiseComponent {
  std::string name;    ///< "corner", "tag", "repeatability", "rounding", "rotation", "position", "scatter joint:3"
  double start = 0.0;  ///< variance to begin from
  bool white = false;  ///< Z is the identity: every row by itself
  std::vector<Eigen::MatrixXd> Z;
};

/// Of readings that were rounded, in units of what that takes from them: 1 where they were, 0 where the arm was sent to round figures.
constexpr const char* kRoundedReadings = "rounding";

/// The components of a capture: corners (px per axis, times the stated sigma), what a whole tag shares (px), and the joints' repeatability
/// (rad; m for sliding joints a tenth of it), one for all joints; for poses rotation and position instead of the first two.
std::vector<NoiseComponent> noiseComponents(const MeasuredCell& measured, const CaptureRows& rows);

/// What the component of joint k (from 0) that moves at random by itself is called.
std::string scatterName(std::size_t k);

/// Joints (from 0) of which there is such a component.
std::vector<std::size_t> scatterOf(const std::vector<NoiseComponent>& components);

/// Joint k (from 0) moving at random from pose to pose, by itself. @param start  variance [rad^2].
NoiseComponent jointScatter(const CaptureRows& rows, std::size_t k, double start);

/// Cholesky factor of a pose's C. @throws InsufficientData where C is singular.
void factorNoise(const Eigen::MatrixXd& C, Eigen::LLT<Eigen::MatrixXd>& llt);

/// Cholesky factors of C, one per pose.
class Whitening {
 public:
  Whitening(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::VectorXd& theta);
  /// L^-1 M, rows of all poses.
  Eigen::MatrixXd apply(const Eigen::MatrixXd& M) const;
  /// L^-1 M for the rows of pose g.
  Eigen::MatrixXd applyTo(std::size_t g, const Eigen::MatrixXd& M) const;
  /// L M for the rows of pose g.
  Eigen::MatrixXd undo(std::size_t g, const Eigen::MatrixXd& M) const { return L_[g] * M; }
  double logDeterminant() const { return log_determinant_; }
  std::size_t poses() const { return L_.size(); }
  int begin(std::size_t g) const { return begin_[g]; }
  int size(std::size_t g) const { return static_cast<int>(L_[g].rows()); }

 private:
  std::vector<int> begin_;
  std::vector<Eigen::MatrixXd> L_;
  double log_determinant_ = 0.0;
};

/// Where an estimate of the noise stands.
struct NoiseEstimate {
  Eigen::VectorXd theta;   ///< variances of the components
  double tolerance = 1.0;  ///< factor by which the arm exceeds its tolerances, >= 1
  double log_likelihood = 0.0;
  double misfit = 0.0;  ///< r' C^-1 r + b0' Lambda b0: where the rows stand, b = 0
  Eigen::VectorXd b;    ///< of the columns
  Eigen::MatrixXd covariance;
};

/// R with R R' = covariance; of eigenvalues that rounding made negative, 0.
Eigen::MatrixXd rootOf(const Eigen::MatrixXd& covariance);

/// Variance of the component of a name; nothing where it was not estimated.
std::optional<double> varianceOf(const std::string& name, const std::vector<NoiseComponent>& components, const NoiseEstimate& noise);

/// Marginal log-likelihood at given variances with columns `extra` beside those of the base model, up to what all models of the same rows
/// share; one estimate for each prior of the columns.
std::vector<NoiseEstimate> likelihoodsAt(const CaptureRows& rows, const std::vector<NoiseComponent>& components,
                                         const Eigen::VectorXd& theta, const Eigen::MatrixXd& extra,
                                         const std::vector<ColumnPrior>& priors);

/// Maximises the marginal likelihood over the variances and the arm's tolerance. @param extra, extra_prior  columns beside those of the
/// base model.
/// @param from  where to begin, or nullptr. @param precision  gain of log-likelihood below which no further step is worth it.
NoiseEstimate estimateNoise(const MeasuredCell& measured, const ModelState& state, const CaptureRows& rows,
                            const std::vector<NoiseComponent>& components, const Eigen::MatrixXd& extra, const ColumnPrior& extra_prior,
                            const NoiseEstimate* from, double precision = 1e-3);

}  // namespace poecal
