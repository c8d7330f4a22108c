#include "poecal/cell/adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "cell/linearisation.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Without noise the scale would fall to rounding and the weights would follow rounding errors; a millionth of the stated sigma is below
// anything that can be measured.
constexpr double kSmallestScale = 1e-6;

using Weights = std::vector<std::vector<double>>;

struct NormalEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};

/// The redescending weight of a unit of `size` numbers with squared norm `t` in units of its present sigma.
class UnitWeight {
 public:
  explicit UnitWeight(int size) : bend_(std::sqrt(chiSquareQuantile(1.0 - 1e-4, size))), median_(chiSquareQuantile(0.5, size)) {}
  double operator()(double t) const {
    const double d = std::sqrt(t);
    if (d <= bend_) return 1.0;
    if (!(d < 2.0 * bend_)) return 0.0;
    const double fall = 2.0 - d / bend_;
    return fall * fall;
  }
  double medianOfSquare() const { return median_; }

 private:
  double bend_;
  double median_;
};

class Adjuster {
 public:
  Adjuster(const Cell& nominal, const std::vector<Observation>& observations, const AdjustmentOptions& options)
      : observations_(observations),
        options_(options),
        layout_(nominal, options.free),
        start_(nominal),
        state_(nominal, options.free),
        sigma_alone_(priorSigma(layout_, options, nominal)) {
    setTolerance(options.tolerance > 0.0 ? options.tolerance : 1.0);
    weights_.reserve(observations.size());
    int numbers = 0;
    for (const Observation& observation : observations) {
      weights_.emplace_back(static_cast<std::size_t>(observation.unitCount()), 1.0);
      numbers += observation.unitCount() * observation.unitSize();
    }
    const auto unbounded = (sigma_alone_.array() == kInfinity).count() - (options.twists.empty() ? 0 : layout_.twists);
    if (numbers < unbounded) {
      throw InsufficientData(fmt::format("{} numbers were measured for {} unknowns: more poses are needed", numbers, unbounded));
    }
    if (!observations.empty()) unit_weight_ = UnitWeight(observations.front().unitSize());
    if (layout_.twists == 0 && layout_.gamma < 0) {
      held_flanges_.reserve(observations.size());
      for (const Observation& observation : observations) held_flanges_.push_back(modelFlange(nominal, observation));
    }
  }

  Adjustment run() {
    std::vector<std::vector<double>> squares = squaredNorms(state_);
    scale_ = options_.scale > 0.0 ? options_.scale : robustScale(squares);
    Adjustment result;
    result.status = layout_.total == 0 ? AdjustmentStatus::kConverged : AdjustmentStatus::kIterationLimit;
    double damping = 1e-10;
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      const double previous_scale = scale_, previous_tolerance = tolerance_;
      updateScaleAndWeights(squares, iteration);
      const NormalEquations normal = accumulate(state_);
      const double cost = costOf(squares, state_);
      result.steps.push_back({cost, rmsOf(squares), scale_});
      const std::optional<double> predicted = step(normal, cost, damping, squares);
      effective_parameters_ = effectiveParameters(normal);
      if (options_.tolerance <= 0.0) updateTolerance(normal);
      const bool settled = (std::abs(scale_ - previous_scale) <= 1e-6 * scale_ || options_.scale > 0.0) &&
                           std::abs(tolerance_ - previous_tolerance) <= 1e-4 * tolerance_;
      // A step of 1e-8 standard deviations, or none that lowers the cost: rounding is reached.
      if ((!predicted || *predicted < 1e-16) && settled && iteration > 1) {
        result.status = AdjustmentStatus::kConverged;
        break;
      }
    }
    finish(squares, result);
    return result;
  }

 private:
  Eigen::Isometry3d targetAt(const CellState& state, std::size_t k) const {
    if (held_flanges_.empty()) return modelTarget(state.cell, observations_[k]);
    return state.cell.registration.cameraTarget(held_flanges_[k]);
  }

  PoseDerivative derivativeAt(const CellState& state, std::size_t k) const {
    if (held_flanges_.empty()) return evaluatePose(state, layout_, observations_[k]);
    return evaluatePose(state, layout_, observations_[k], ArmChain{.P = {}, .T_base_flange = held_flanges_[k]});
  }

  std::vector<std::vector<double>> squaredNorms(const CellState& state) const {
    std::vector<std::vector<double>> squares;
    squares.reserve(observations_.size());
    SampleRows rows;
    for (std::size_t k = 0; k < observations_.size(); ++k) {
      evaluateRows(state.cell, observations_[k], targetAt(state, k), false, rows);
      std::vector<double> of_units(rows.valid.size());
      for (std::size_t unit = 0; unit < of_units.size(); ++unit) {
        of_units[unit] =
            rows.valid[unit] ? rows.r.segment(static_cast<int>(unit) * rows.unit_size, rows.unit_size).squaredNorm() : kInfinity;
      }
      squares.push_back(std::move(of_units));
    }
    return squares;
  }

  double robustScale(const std::vector<std::vector<double>>& squares) const {
    std::vector<double> all;
    for (const auto& of_units : squares) all.insert(all.end(), of_units.begin(), of_units.end());
    if (all.empty()) return 1.0;
    return std::max(kSmallestScale, std::sqrt(median(std::move(all)) / unit_weight_.medianOfSquare()));
  }

  void updateScaleAndWeights(const std::vector<std::vector<double>>& squares, int iteration) {
    const double robust_scale = robustScale(squares);
    for (std::size_t k = 0; k < squares.size(); ++k) {
      for (std::size_t unit = 0; unit < squares[k].size(); ++unit) {
        const double square = squares[k][unit];
        weights_[k][unit] = options_.robust ? unit_weight_(square / (robust_scale * robust_scale)) : (std::isfinite(square) ? 1.0 : 0.0);
      }
    }
    if (options_.scale > 0.0) return;
    // The median serves while the fit is far off; at the end all good units count.
    const double dof = usedNumbers() - effective_parameters_;
    scale_ = robust_scale;
    if (iteration > 0 && dof > 0.0) scale_ = std::max(kSmallestScale, std::sqrt(chiSquare(squares) / dof));
  }

  double usedNumbers() const {
    double used = 0.0;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      for (const double w : weights_[k]) used += w * observations_[k].unitSize();
    }
    return used;
  }

  double chiSquare(const std::vector<std::vector<double>>& squares) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < squares.size(); ++k) {
      for (std::size_t unit = 0; unit < squares[k].size(); ++unit) {
        if (weights_[k][unit] > 0.0) sum += weights_[k][unit] * squares[k][unit];
      }
    }
    return sum;
  }

  double rmsOf(const std::vector<std::vector<double>>& squares) const {
    double units = 0.0;
    for (const auto& of_units : weights_) {
      for (const double w : of_units) units += w;
    }
    return units > 0.0 ? std::sqrt(chiSquare(squares) / units) : 0.0;
  }

  double costOf(const std::vector<std::vector<double>>& squares, const CellState& state) const {
    const Eigen::VectorXd deviation = priorDeviation(state, layout_, start_);
    return chiSquare(squares) / (scale_ * scale_) + deviation.dot(prior_information_ * deviation);
  }

  NormalEquations accumulate(const CellState& state) const {
    NormalEquations normal{Eigen::MatrixXd::Zero(layout_.total, layout_.total), Eigen::VectorXd::Zero(layout_.total)};
    const bool intrinsics = layout_.intrinsics >= 0;
    const int p = layout_.pose_parameters;
    const int k_count = layout_.total - p;
    SampleRows rows;
    for (std::size_t k = 0; k < observations_.size(); ++k) {
      const PoseDerivative pose = derivativeAt(state, k);
      evaluateRows(state.cell, observations_[k], pose.T_camera_target, intrinsics, rows);
      for (std::size_t unit = 0; unit < rows.valid.size(); ++unit) {
        const double root = rows.valid[unit] ? std::sqrt(weights_[k][unit]) : 0.0;
        const int row = static_cast<int>(unit) * rows.unit_size;
        rows.r.segment(row, rows.unit_size) *= root;
        rows.H.middleRows(row, rows.unit_size) *= root;
        if (intrinsics) rows.K.middleRows(row, rows.unit_size) *= root;
      }
      const Matrix6d S = rows.H.transpose() * rows.H;
      const Vector6d s = rows.H.transpose() * rows.r;
      normal.H.topLeftCorner(p, p).noalias() += pose.M.transpose() * (S * pose.M);
      normal.g.head(p).noalias() += pose.M.transpose() * s;
      if (intrinsics) {
        const Eigen::MatrixXd C = rows.H.transpose() * rows.K;
        normal.H.topRightCorner(p, k_count).noalias() += pose.M.transpose() * C;
        normal.H.bottomRightCorner(k_count, k_count).noalias() += rows.K.transpose() * rows.K;
        normal.g.tail(k_count).noalias() += rows.K.transpose() * rows.r;
      }
    }
    normal.H.bottomLeftCorner(k_count, p) = normal.H.topRightCorner(p, k_count).transpose();
    normal.H /= scale_ * scale_;
    normal.g /= scale_ * scale_;
    return normal;
  }

  /// The twists' prior widened by `tolerance`, beside the independent ones.
  void setTolerance(double tolerance) {
    tolerance_ = tolerance;
    prior_information_ = sigma_alone_.array().square().inverse().matrix().asDiagonal();
    if (!options_.twists.empty() && layout_.twists > 0) {
      prior_information_.topLeftCorner(layout_.twists, layout_.twists) = options_.twists.precision / (tolerance * tolerance);
    }
  }

  void updateTolerance(const NormalEquations& normal) {
    if (options_.twists.empty() || layout_.twists == 0) return;
    const Eigen::MatrixXd H = normal.H + prior_information_;
    const Eigen::VectorXd d = columnScale(H);
    const Eigen::MatrixXd scaled = d.asDiagonal() * H * d.asDiagonal();
    const Eigen::MatrixXd inverse =
        d.asDiagonal() * scaled.ldlt().solve(Eigen::MatrixXd::Identity(layout_.total, layout_.total)) * d.asDiagonal();
    setTolerance(updatedTolerance(options_.twists, state_.beta, inverse.topLeftCorner(layout_.twists, layout_.twists), tolerance_));
  }

  /// Columns to unit length, so that one damping and one cutoff serve radians, metres and pixels.
  static Eigen::VectorXd columnScale(const Eigen::MatrixXd& H) {
    return H.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 1.0; });
  }

  /// Takes one damped step; returns the decrease it predicted, or nothing where no damping lowers the cost.
  std::optional<double> step(const NormalEquations& normal, double cost, double& damping, std::vector<std::vector<double>>& squares) {
    if (layout_.total == 0) return std::nullopt;
    const Eigen::MatrixXd H = normal.H + prior_information_;
    const Eigen::VectorXd g = normal.g - prior_information_ * priorDeviation(state_, layout_, start_);
    const Eigen::VectorXd d = columnScale(H);
    const Eigen::MatrixXd scaled = d.asDiagonal() * H * d.asDiagonal();
    for (int attempt = 0; attempt < 30; ++attempt, damping = std::max(10.0 * damping, 1e-9)) {
      Eigen::MatrixXd damped = scaled;
      damped.diagonal().array() += damping;
      const Eigen::VectorXd dx = d.cwiseProduct(damped.ldlt().solve(d.cwiseProduct(g)));
      const double predicted = dx.dot(g);
      CellState next = state_.moved(layout_, dx);
      std::vector<std::vector<double>> next_squares = squaredNorms(next);
      const double next_cost = costOf(next_squares, next);
      if (std::isfinite(next_cost) && next_cost <= cost) {
        state_ = std::move(next);
        squares = std::move(next_squares);
        damping = damping < 1e-11 ? 0.0 : 0.1 * damping;
        return predicted;
      }
      if (predicted < 1e-12) return std::nullopt;
    }
    return std::nullopt;
  }

  /// Number of parameters that the data determine: trace(H_data (H_data + H_prior)^-1).
  double effectiveParameters(const NormalEquations& normal) const {
    if (layout_.total == 0) return 0.0;
    const Eigen::MatrixXd H = normal.H + prior_information_;
    const Eigen::VectorXd d = columnScale(H);
    Eigen::MatrixXd scaled = d.asDiagonal() * H * d.asDiagonal();
    // Where nothing determines a direction both matrices are rounding, 1e-16; this keeps their quotient from counting.
    scaled.diagonal().array() += 1e-10;
    const Eigen::MatrixXd data = d.asDiagonal() * normal.H * d.asDiagonal();
    return scaled.ldlt().solve(data).trace();
  }

  void finish(const std::vector<std::vector<double>>& squares, Adjustment& result) {
    const NormalEquations normal = accumulate(state_);
    result.cell = state_.cell;
    result.beta = state_.beta;
    result.names = parameterNames(state_.cell, options_.free);
    result.sigma_prior = priorSquareRoot().rowwise().norm();
    result.scale = scale_;
    result.tolerance = tolerance_;
    result.weights = weights_;
    result.chi_square = chiSquare(squares);
    result.degrees_of_freedom = usedNumbers() - effectiveParameters(normal);
    result.steps.push_back({costOf(squares, state_), rmsOf(squares), scale_});
    if (layout_.total == 0) return;
    const Eigen::MatrixXd H = normal.H + prior_information_;
    const Eigen::VectorXd d = columnScale(H);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(d.asDiagonal() * H * d.asDiagonal());
    // The square of the relative precision that sums of squares keep.
    constexpr double kCutoff = 1e-13;
    const double largest = eigen.eigenvalues().maxCoeff();
    double smallest_kept = largest;
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(layout_.total);
    for (int k = 0; k < layout_.total; ++k) {
      if (eigen.eigenvalues()(k) <= kCutoff * largest) continue;
      inverse(k) = 1.0 / eigen.eigenvalues()(k);
      smallest_kept = std::min(smallest_kept, eigen.eigenvalues()(k));
      ++result.rank;
    }
    result.condition_number = std::sqrt(largest / smallest_kept);
    result.covariance = d.asDiagonal() * (eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose()) * d.asDiagonal();
    nameUnseen(normal, result);
  }

  /// A root S of the prior's covariance S S^T; infinite on the diagonal where there is no prior.
  Eigen::MatrixXd priorSquareRoot() const {
    Eigen::MatrixXd root = sigma_alone_.asDiagonal();
    if (!options_.twists.empty() && layout_.twists > 0) {
      const Eigen::MatrixXd upper = options_.twists.precision.llt().matrixU();
      root.topLeftCorner(layout_.twists, layout_.twists) =
          tolerance_ * upper.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(layout_.twists, layout_.twists));
    }
    return root;
  }

  /// Directions in which the data say less than the prior, or, where there is none, than one rad, metre or pixel.
  void nameUnseen(const NormalEquations& normal, Adjustment& result) const {
    Eigen::MatrixXd unit = priorSquareRoot();
    unit = unit.unaryExpr([](double s) { return std::isfinite(s) ? s : 1.0; });
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.transpose() * normal.H * unit);
    const Eigen::VectorXd typical = unit.rowwise().norm();
    for (int k = 0; k < layout_.total && eigen.eigenvalues()(k) < 1.0; ++k) {
      const Eigen::VectorXd direction = (unit * eigen.eigenvectors().col(k)).cwiseAbs().cwiseQuotient(typical);
      std::vector<std::string> carriers;
      for (int i = 0; i < layout_.total; ++i) {
        if (direction(i) > 0.5 * direction.maxCoeff()) carriers.push_back(result.names[static_cast<std::size_t>(i)]);
      }
      std::string text;
      for (const std::string& name : carriers) text += (text.empty() ? "" : " with ") + name;
      result.unseen.push_back(text);
    }
  }

  const std::vector<Observation>& observations_;
  const AdjustmentOptions& options_;
  ParameterLayout layout_;
  Cell start_;
  CellState state_;
  Eigen::VectorXd sigma_alone_;  ///< 1 sigma of the independent priors; infinity where there is none
  Eigen::MatrixXd prior_information_;
  double tolerance_ = 1.0;
  std::vector<Eigen::Isometry3d> held_flanges_;  ///< of each observation, where the arm is held; otherwise empty
  Weights weights_;
  UnitWeight unit_weight_{2};
  double scale_ = 1.0;
  double effective_parameters_ = 0.0;
};

}  // namespace

Eigen::Vector3d farMotion(const Cell& cell, const Cell& start) {
  return logSe3(cell.registration.T_far_target * start.registration.T_far_target.inverse()).tail<3>();
}

Adjustment adjust(const Cell& nominal, const std::vector<Observation>& observations, const AdjustmentOptions& options) {
  return Adjuster(nominal, observations, options).run();
}

std::vector<UnitResidual> residuals(const Cell& cell, const Observation& observation) {
  std::vector<UnitResidual> units;
  const Eigen::Isometry3d T_camera_target = modelTarget(cell, observation);
  SampleRows rows;
  evaluateRows(cell, observation, T_camera_target, false, rows);
  for (std::size_t unit = 0; unit < rows.valid.size(); ++unit) {
    UnitResidual result;
    const Eigen::VectorXd r = rows.r.segment(static_cast<int>(unit) * rows.unit_size, rows.unit_size);
    result.squared_norm = rows.valid[unit] ? r.squaredNorm() : kInfinity;
    if (observation.pose) {
      result.residual = poseDifference(observation.pose->T_camera_target, T_camera_target).tail(rows.unit_size);
    } else {
      result.residual = rows.valid[unit] ? Eigen::VectorXd(r * observation.corners[unit].sigma_px)
                                         : Eigen::VectorXd::Constant(2, std::numeric_limits<double>::quiet_NaN());
    }
    units.push_back(std::move(result));
  }
  return units;
}

Matrix6d targetPoseCovariance(const Adjustment& adjustment, const Cell& nominal, const FreeParameters& free, const Observation& at) {
  const ParameterLayout layout(nominal, free);
  CellState state(nominal, free);
  state.cell = adjustment.cell;
  state.beta = adjustment.beta;
  if (state.reference) state.reference->gamma = adjustment.cell.arm->gamma;
  const PoseDerivative pose = evaluatePose(state, layout, at);
  const int p = layout.pose_parameters;
  return pose.M * adjustment.covariance.topLeftCorner(p, p) * pose.M.transpose();
}

}  // namespace poecal
