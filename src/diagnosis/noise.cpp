#include "diagnosis/noise.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr double kStartCorner = 0.1;          // [px]
constexpr double kStartTag = 0.02;            // [px]
constexpr double kStartRepeatability = 2e-5;  // [rad]

int groupRows(const CaptureRows& rows, std::size_t g) {
  int count = 0;
  for (const std::size_t k : rows.groups[g]) count += rows.observations[k].size;
  return count;
}

/// One component from a function that gives its columns in one observation. Columns of the observations of a pose stand side by side, or,
/// where the pose has one draw for all its shots, below each other.
template <typename Columns>
NoiseComponent component(const CaptureRows& rows, const std::string& name, double start, bool shared_by_shots, Columns columns) {
  NoiseComponent made{.name = name, .start = start, .Z = {}};
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    std::vector<Eigen::MatrixXd> parts;
    Eigen::Index width = 0;
    for (const std::size_t k : rows.groups[g]) {
      parts.push_back(columns(rows.observations[k]));
      width = shared_by_shots ? parts.back().cols() : width + parts.back().cols();
    }
    Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(groupRows(rows, g), width);
    Eigen::Index row = 0, column = 0;
    for (const Eigen::MatrixXd& part : parts) {
      Z.block(row, column, part.rows(), part.cols()) = part;
      row += part.rows();
      if (!shared_by_shots) column += part.cols();
    }
    made.Z.push_back(std::move(Z));
  }
  return made;
}

/// What a shift of a whole tag in u and in v moves, two columns a tag.
Eigen::MatrixXd tagColumns(const ObservationRows& part) {
  std::map<int, Eigen::Index> tags;
  for (const PointContext& point : part.context.points) tags.emplace(point.id.tag, 0);
  Eigen::Index column = 0;
  for (auto& [tag, begin] : tags) begin = 2 * column++;
  Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(part.size, 2 * column);
  for (std::size_t j = 0; j < part.context.points.size(); ++j) {
    const auto row = 2 * static_cast<Eigen::Index>(j);
    const Eigen::Index begin = tags.at(part.context.points[j].id.tag);
    Z(row, begin) = Z(row + 1, begin + 1) = 1.0 / part.unit_sigma[j];
  }
  return Z;
}

/// What one draw of each joint's repeatability moves.
Eigen::MatrixXd jointColumns(const MeasuredCell& measured, const ObservationRows& part) {
  Eigen::MatrixXd Z = part.rows.H * part.ports.joints;
  for (Eigen::Index k = 0; k < Z.cols(); ++k) {
    if (measured.start.arm->joints[static_cast<std::size_t>(k)].type == JointType::kPrismatic) Z.col(k) *= kMetresPerRadian;
  }
  return Z;
}

bool hasRedundantTags(const CaptureRows& rows) {
  return std::any_of(rows.observations.begin(), rows.observations.end(), [](const ObservationRows& part) {
    std::map<int, int> corners;
    for (const PointContext& point : part.context.points) ++corners[point.id.tag];
    return std::any_of(corners.begin(), corners.end(), [](const auto& tag) { return tag.second > 1; });
  });
}

/// Rows of the poses and what they say of the columns, at one C.
struct Normal {
  Eigen::MatrixXd A;  ///< X' C^-1 X + Lambda
  Eigen::VectorXd g;  ///< X' C^-1 r - Lambda b0
  Eigen::MatrixXd X;  ///< whitened
  Eigen::VectorXd r;  ///< whitened
};

Normal normalOf(const Whitening& whitening, const CaptureRows& rows, const Eigen::MatrixXd& X, const ColumnPrior& prior) {
  Normal normal;
  normal.X = whitening.apply(X);
  normal.r = whitening.apply(rows.r);
  normal.A = normal.X.transpose() * normal.X + prior.precision;
  normal.g = normal.X.transpose() * normal.r - prior.precision * prior.offset;
  return normal;
}

/// Inverse with columns scaled to unit length first; radians, metres and pixels stand side by side.
class ScaledInverse {
 public:
  explicit ScaledInverse(const Eigen::MatrixXd& A)
      : d_(A.diagonal().unaryExpr([](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 1.0; })) {
    Eigen::MatrixXd scaled = d_.asDiagonal() * A * d_.asDiagonal();
    // What nothing determines must not come out as rounding over rounding.
    scaled.diagonal().array() += 1e-12;
    llt_.compute(scaled);
    log_determinant_ = 2.0 * llt_.matrixLLT().diagonal().array().log().sum() - 2.0 * d_.array().log().sum();
  }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const { return d_.asDiagonal() * llt_.solve(Eigen::MatrixXd(d_.asDiagonal() * B)); }
  double logDeterminant() const { return log_determinant_; }

 private:
  Eigen::VectorXd d_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  double log_determinant_ = 0.0;
};

NoiseEstimate evaluated(const Whitening& whitening, const Normal& normal, const Eigen::VectorXd& theta, const ColumnPrior& prior,
                        const ScaledInverse& inverse) {
  NoiseEstimate estimate;
  estimate.theta = theta;
  estimate.b = inverse.solve(normal.g);
  const double constant = prior.offset.dot(prior.precision * prior.offset);
  const double quadratic = normal.r.squaredNorm() + constant - estimate.b.dot(normal.g);
  estimate.log_likelihood = -0.5 * (whitening.logDeterminant() + inverse.logDeterminant() - prior.log_determinant + quadratic);
  return estimate;
}

/// What is believed of a variance before: joints come back to some 1e-5 rad, and farther is believed less and less.
struct VariancePrior {
  double penalty = 0.0;                    ///< units of log-likelihood
  double gradient = 0.0, curvature = 0.0;  ///< of the penalty by log theta
};

VariancePrior variancePrior(const NoiseComponent& component, double theta) {
  constexpr double kUsual = 5e-5;   // [rad], as makers state it
  constexpr double kSpread = 0.35;  // of its logarithm: twice as much is two standard deviations away
  const double above = 0.5 * std::log(theta / (kUsual * kUsual)) / kSpread;
  if (component.name != "repeatability" || !(above > 0.0)) return {};
  return {0.5 * above * above, 0.5 * above / kSpread, 0.25 / (kSpread * kSpread)};
}

/// Gradient and average information of the log-likelihood by log theta.
struct Slope {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

Slope slopeOf(const Whitening& whitening, const Normal& normal, const Eigen::VectorXd& b, const std::vector<NoiseComponent>& components,
              const Eigen::VectorXd& theta, const ScaledInverse& inverse) {
  const auto count = static_cast<Eigen::Index>(components.size());
  const Eigen::VectorXd residual = normal.r - normal.X * b;  // L^-1 (r - X b)
  Eigen::MatrixXd moved(residual.size(), count);             // L^-1 V_i P r
  Slope slope;
  slope.gradient.resize(count);
  std::vector<Eigen::MatrixXd> spread(components.size(), Eigen::MatrixXd::Zero(b.size(), b.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    double trace = 0.0, quadratic = 0.0;
    for (std::size_t g = 0; g < whitening.poses(); ++g) {
      const Eigen::MatrixXd& Z = components[static_cast<std::size_t>(i)].Z[g];
      const int begin = whitening.begin(g), size = whitening.size(g);
      if (Z.cols() == 0) {
        moved.block(begin, i, size, 1).setZero();
        continue;
      }
      const Eigen::MatrixXd W = whitening.applyTo(g, Z);
      const Eigen::VectorXd projected = W.transpose() * residual.segment(begin, size);
      trace += W.squaredNorm();
      quadratic += projected.squaredNorm();
      moved.block(begin, i, size, 1) = W * projected;
      const Eigen::MatrixXd cross = normal.X.middleRows(begin, size).transpose() * W;
      spread[static_cast<std::size_t>(i)].noalias() += cross * cross.transpose();
    }
    const double taken = inverse.solve(spread[static_cast<std::size_t>(i)]).trace();
    slope.gradient(i) = 0.5 * theta(i) * (quadratic - (trace - taken));
  }
  const Eigen::MatrixXd cross = normal.X.transpose() * moved;
  slope.information = 0.5 * (moved.transpose() * moved - cross.transpose() * inverse.solve(cross));
  slope.information = theta.asDiagonal() * slope.information * theta.asDiagonal();
  for (Eigen::Index i = 0; i < count; ++i) {
    const VariancePrior prior = variancePrior(components[static_cast<std::size_t>(i)], theta(i));
    slope.gradient(i) -= prior.gradient;
    slope.information(i, i) += prior.curvature;
  }
  return slope;
}

/// MacKay's fixed point for the factor by which the arm exceeds its tolerances; see basePrior.
double updatedTolerance(const MeasuredCell& measured, const ModelState& state, const Eigen::VectorXd& b, const ScaledInverse& inverse,
                        double tolerance, Eigen::Index columns) {
  const Eigen::Index twists = measured.twist_covariance.rows();
  if (twists == 0) return 1.0;
  const Eigen::LLT<Eigen::MatrixXd> covariance(measured.twist_covariance);
  const Eigen::VectorXd beta = state.cell.beta + b.head(twists);
  const Eigen::MatrixXd variance = inverse.solve(Eigen::MatrixXd::Identity(columns, columns)).topLeftCorner(twists, twists);
  const double spread = beta.dot(covariance.solve(beta));
  const double known = static_cast<double>(twists) - covariance.solve(variance).trace() / (tolerance * tolerance);
  return std::clamp(std::sqrt(spread / std::max(known, 1.0)), 1.0, 1e3);
}

/// An arm beyond its tolerances is believed less and less: a factor e costs two units of log-likelihood.
double tolerancePenalty(double tolerance) { return 2.0 * std::pow(std::log(tolerance), 2); }

/// All that is known at one set of variances.
struct NoisePoint {
  NoisePoint(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::VectorXd& theta, const Eigen::MatrixXd& X,
             const ColumnPrior& prior, double tolerance)
      : whitening(rows, components, theta), normal(normalOf(whitening, rows, X, prior)), inverse(normal.A) {
    estimate = evaluated(whitening, normal, theta, prior, inverse);
    estimate.tolerance = tolerance;
    estimate.log_likelihood -= tolerancePenalty(tolerance);
    for (std::size_t i = 0; i < components.size(); ++i) {
      estimate.log_likelihood -= variancePrior(components[i], theta(static_cast<Eigen::Index>(i))).penalty;
    }
  }
  Whitening whitening;
  Normal normal;
  ScaledInverse inverse;
  NoiseEstimate estimate;
};

}  // namespace

std::vector<NoiseComponent> noiseComponents(const MeasuredCell& measured, const CaptureRows& rows) {
  std::vector<NoiseComponent> components;
  const auto identity = [](const ObservationRows& part) { return Eigen::MatrixXd(Eigen::MatrixXd::Identity(part.size, part.size)); };
  const bool corners = measured.start.camera.has_value();
  if (corners) {
    components.push_back(component(rows, "corner", kStartCorner * kStartCorner, false, identity));
    if (hasRedundantTags(rows)) components.push_back(component(rows, "tag", kStartTag * kStartTag, false, tagColumns));
  } else {
    const auto part_of = [](Eigen::Index begin) {
      return [begin](const ObservationRows& part) {
        return Eigen::MatrixXd(Eigen::MatrixXd::Identity(part.size, part.size).middleCols(part.size == 6 ? begin : 0, 3));
      };
    };
    const bool whole =
        std::any_of(rows.observations.begin(), rows.observations.end(), [](const ObservationRows& p) { return p.size == 6; });
    if (whole) components.push_back(component(rows, "rotation", 1.0, false, part_of(0)));
    components.push_back(component(rows, "position", 1.0, false, part_of(3)));
  }
  const bool arm =
      std::any_of(rows.observations.begin(), rows.observations.end(), [](const ObservationRows& p) { return p.ports.joints.cols() > 0; });
  if (arm && corners) {
    components.push_back(component(rows, "repeatability", kStartRepeatability * kStartRepeatability, true,
                                   [&measured](const ObservationRows& part) { return jointColumns(measured, part); }));
  }
  return components;
}

std::string scatterName(std::size_t k) { return fmt::format("scatter joint:{}", k + 1); }

NoiseComponent jointScatter(const CaptureRows& rows, std::size_t k, double start) {
  return component(rows, scatterName(k), start, true, [k](const ObservationRows& part) {
    return Eigen::MatrixXd(part.rows.H * part.ports.joints.col(static_cast<Eigen::Index>(k)));
  });
}

ColumnPrior ColumnPrior::none(Eigen::Index columns) {
  return {Eigen::VectorXd::Zero(columns), Eigen::MatrixXd::Zero(columns, columns), 0.0};
}

ColumnPrior ColumnPrior::independent(const Eigen::VectorXd& sigma, const Eigen::VectorXd& offset) {
  ColumnPrior prior{offset, sigma.array().square().inverse().matrix().asDiagonal(), 0.0};
  prior.log_determinant = -2.0 * sigma.array().log().sum();
  return prior;
}

ColumnPrior ColumnPrior::joinedWith(const ColumnPrior& other) const {
  ColumnPrior both = none(offset.size() + other.offset.size());
  both.offset << offset, other.offset;
  both.precision.topLeftCorner(offset.size(), offset.size()) = precision;
  both.precision.bottomRightCorner(other.offset.size(), other.offset.size()) = other.precision;
  both.log_determinant = log_determinant + other.log_determinant;
  return both;
}

ColumnPrior basePrior(const MeasuredCell& measured, const ModelState& state, double tolerance) {
  const ParameterLayout layout(state.cell.cell, measured.free);
  ColumnPrior prior = ColumnPrior::none(layout.total);
  const Eigen::Index twists = measured.twist_covariance.rows();
  if (twists > 0) {
    const Eigen::LLT<Eigen::MatrixXd> llt(measured.twist_covariance * (tolerance * tolerance));
    prior.precision.topLeftCorner(twists, twists) = llt.solve(Eigen::MatrixXd::Identity(twists, twists));
    prior.offset.head(twists) = state.cell.beta;
    prior.log_determinant -= 2.0 * llt.matrixLLT().diagonal().array().log().sum();
  }
  if (layout.far >= 0) {
    prior.precision.diagonal().segment<3>(layout.far + 3).setConstant(1.0 / (kFarPosition * kFarPosition));
    prior.offset.segment<3>(layout.far + 3) = farMotion(state.cell.cell, measured.start);
    prior.log_determinant -= 6.0 * std::log(kFarPosition);
  }
  if (layout.intrinsics >= 0) {
    const Eigen::VectorXd move = state.cell.cell.camera->parameters() - measured.start.camera->parameters();
    for (Eigen::Index k = 0; k < measured.camera_sigma.size(); ++k) {
      const double sigma = measured.camera_sigma(k);
      if (!(sigma > 0.0)) continue;
      prior.precision(layout.intrinsics + k, layout.intrinsics + k) = 1.0 / (sigma * sigma);
      prior.offset(layout.intrinsics + k) = move(k);
      prior.log_determinant -= 2.0 * std::log(sigma);
    }
  }
  return prior;
}

Whitening::Whitening(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::VectorXd& theta) {
  int begin = 0;
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    const int size = groupRows(rows, g);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t i = 0; i < components.size(); ++i) {
      const Eigen::MatrixXd& Z = components[i].Z[g];
      if (Z.cols() > 0) C.noalias() += theta(static_cast<Eigen::Index>(i)) * (Z * Z.transpose());
    }
    Eigen::LLT<Eigen::MatrixXd> llt(C);
    if (llt.info() != Eigen::Success)
      throw InsufficientData("the noise of a pose cannot be told from nothing: its rows repeat each other exactly");
    log_determinant_ += 2.0 * llt.matrixLLT().diagonal().array().log().sum();
    begin_.push_back(begin);
    L_.push_back(llt.matrixL());
    begin += size;
  }
}

Eigen::MatrixXd Whitening::applyTo(std::size_t g, const Eigen::MatrixXd& M) const { return L_[g].triangularView<Eigen::Lower>().solve(M); }

Eigen::MatrixXd Whitening::apply(const Eigen::MatrixXd& M) const {
  Eigen::MatrixXd white(M.rows(), M.cols());
  for (std::size_t g = 0; g < L_.size(); ++g) white.middleRows(begin_[g], size(g)) = applyTo(g, M.middleRows(begin_[g], size(g)));
  return white;
}

std::optional<double> varianceOf(const std::string& name, const std::vector<NoiseComponent>& components, const NoiseEstimate& noise) {
  const auto found = std::find_if(components.begin(), components.end(), [&name](const NoiseComponent& each) { return each.name == name; });
  if (found == components.end()) return {};
  return noise.theta(found - components.begin());
}

NoiseEstimate likelihoodAt(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::VectorXd& theta,
                           const Eigen::MatrixXd& X, const ColumnPrior& prior) {
  const Whitening whitening(rows, components, theta);
  const Normal normal = normalOf(whitening, rows, X, prior);
  const ScaledInverse inverse(normal.A);
  NoiseEstimate estimate = evaluated(whitening, normal, theta, prior, inverse);
  estimate.covariance = inverse.solve(Eigen::MatrixXd::Identity(X.cols(), X.cols()));
  return estimate;
}

NoiseEstimate estimateNoise(const MeasuredCell& measured, const ModelState& state, const CaptureRows& rows,
                            const std::vector<NoiseComponent>& components, const Eigen::MatrixXd& extra, const ColumnPrior& extra_prior,
                            const NoiseEstimate* from, double precision) {
  Eigen::MatrixXd X(rows.J.rows(), rows.J.cols() + extra.cols());
  X << rows.J, extra;
  const auto count = static_cast<Eigen::Index>(components.size());
  Eigen::VectorXd start(count);
  for (Eigen::Index i = 0; i < count; ++i) start(i) = components[static_cast<std::size_t>(i)].start;
  double tolerance = 1.0;
  if (from != nullptr) {
    const Eigen::Index known = std::min(count, from->theta.size());
    start.head(known) = from->theta.head(known);
    tolerance = from->tolerance;
  }
  const Eigen::VectorXd floor =
      Eigen::VectorXd::NullaryExpr(count, [&components](Eigen::Index i) { return 1e-6 * components[static_cast<std::size_t>(i)].start; });
  // One that an earlier estimate found to be nothing begins small, not at nothing, from where its logarithm would not come back.
  constexpr double kSmallStart = 0.05;
  Eigen::VectorXd theta = start.cwiseMax(1e6 * kSmallStart * floor);
  double damping = 1e-3;
  std::unique_ptr<const NoisePoint> best;
  constexpr int kMaxSteps = 40;
  for (int step = 0; step < kMaxSteps; ++step) {
    auto here = std::make_unique<const NoisePoint>(rows, components, theta, X,
                                                   basePrior(measured, state, tolerance).joinedWith(extra_prior), tolerance);
    const double gain = best ? here->estimate.log_likelihood - best->estimate.log_likelihood : 1.0;
    if (best && gain < -1e-9) {
      damping *= 10.0;
      if (damping > 1e6) break;
    } else {
      const bool settled = best && gain < precision;
      best = std::move(here);
      if (settled) break;
      damping = std::max(1e-6, 0.1 * damping);
    }
    Slope slope = slopeOf(best->whitening, best->normal, best->estimate.b, components, best->estimate.theta, best->inverse);
    slope.information.diagonal().array() += damping * (slope.information.diagonal().array() + 1.0);
    Eigen::VectorXd move = slope.information.ldlt().solve(slope.gradient);
    if (!move.allFinite()) break;
    move = move.cwiseMax(-3.0).cwiseMin(3.0);
    theta = (best->estimate.theta.array() * move.array().exp()).matrix().cwiseMax(floor);
    tolerance = updatedTolerance(measured, state, best->estimate.b, best->inverse, best->estimate.tolerance, X.cols());
  }
  NoiseEstimate estimate = best->estimate;
  estimate.covariance = best->inverse.solve(Eigen::MatrixXd::Identity(X.cols(), X.cols()));
  return estimate;
}

}  // namespace poecal
