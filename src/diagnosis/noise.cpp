#include "diagnosis/noise.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "diagnosis/condensed_rows.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr double kStartCorner = 0.1;          // [px]
constexpr double kStartTag = 0.02;            // [px]
constexpr double kStartRepeatability = 2e-5;  // [rad]

/// One component from a function that gives its columns in one observation. Columns of the observations of a pose stand side by side, or,
/// where the pose has one draw for all its shots, below each other.
template <typename Columns>
NoiseComponent component(const CaptureRows& rows, const std::string& name, double start, bool shared_by_shots, Columns columns) {
  NoiseComponent made{.name = name, .start = start, .Z = {}};
  made.Z.reserve(rows.groups.size());
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    Eigen::MatrixXd Z = columns(rows.observations[rows.groups[g].front()]);
    for (std::size_t shot = 1; shot < rows.groups[g].size(); ++shot) {
      const Eigen::MatrixXd part = columns(rows.observations[rows.groups[g][shot]]);
      const Eigen::Index row = Z.rows(), column = shared_by_shots ? 0 : Z.cols();
      Z.conservativeResizeLike(Eigen::MatrixXd::Zero(row + part.rows(), column + part.cols()));
      Z.block(row, column, part.rows(), part.cols()) = part;
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

/// What the rows say of the columns at one set of variances, whatever is believed of the columns.
struct Normal {
  Eigen::MatrixXd squares;       ///< [X r]' C^-1 [X r]
  double log_determinant = 0.0;  ///< of C
};

Normal normalOf(const CondensedRows& rows, const Eigen::VectorXd& theta) {
  Normal normal{Eigen::MatrixXd::Zero(rows.Xr.cols(), rows.Xr.cols()), 0.0};
  forWhitenedPoses(rows, theta, [&normal](const WhitenedPoses& some) {
    normal.squares.selfadjointView<Eigen::Lower>().rankUpdate(some.Xr.transpose());
    for (const Eigen::MatrixXd& whitener : some.whitener) normal.log_determinant -= 2.0 * whitener.diagonal().array().log().sum();
  });
  normal.squares.triangularView<Eigen::StrictlyUpper>() = normal.squares.transpose();
  if (rows.white) {
    const double variance = theta(static_cast<Eigen::Index>(*rows.white));
    normal.squares += rows.squares / variance;
    normal.log_determinant += rows.beyond * std::log(variance);
  }
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
  /// F with F' F the inverse, times B.
  Eigen::MatrixXd half(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd halved = d_.asDiagonal() * B;
    llt_.matrixL().solveInPlace(halved);
    return halved;
  }
  double logDeterminant() const { return log_determinant_; }

 private:
  Eigen::VectorXd d_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  double log_determinant_ = 0.0;
};

/// What follows from the rows and the prior together.
struct Posterior {
  Posterior(const Normal& normal, const Eigen::VectorXd& theta, const ColumnPrior& prior)
      : columns(normal.squares.cols() - 1), inverse(normal.squares.topLeftCorner(columns, columns) + prior.precision) {
    const Eigen::VectorXd g = normal.squares.topRightCorner(columns, 1) - prior.precision * prior.offset;
    estimate.theta = theta;
    estimate.b = inverse.solve(g);
    estimate.misfit = normal.squares(columns, columns) + prior.offset.dot(prior.precision * prior.offset);
    const double quadratic = estimate.misfit - estimate.b.dot(g);
    estimate.log_likelihood = -0.5 * (normal.log_determinant + inverse.logDeterminant() - prior.log_determinant + quadratic);
  }
  Eigen::MatrixXd covariance() const { return inverse.solve(Eigen::MatrixXd::Identity(columns, columns)); }

  Eigen::Index columns;
  ScaledInverse inverse;
  NoiseEstimate estimate;
};

/// What is believed of a variance before: joints come back to some 1e-5 rad, and farther is believed less and less. Rounding is all there
/// when readings were rounded and nothing when they were commanded so, but never more.
struct VariancePrior {
  double penalty = 0.0;                    ///< units of log-likelihood
  double gradient = 0.0, curvature = 0.0;  ///< of the penalty by log theta
};

VariancePrior variancePrior(const NoiseComponent& component, double theta) {
  constexpr double kUsual = 5e-5;   // [rad], as makers state it
  constexpr double kSpread = 0.35;  // of its logarithm: twice as much is two standard deviations away
  const bool rounds = component.name == kRoundedReadings;
  const double above = 0.5 * std::log(rounds ? theta : theta / (kUsual * kUsual)) / kSpread;
  if ((component.name != "repeatability" && !rounds) || !(above > 0.0)) return {};
  return {0.5 * above * above, 0.5 * above / kSpread, 0.25 / (kSpread * kSpread)};
}

/// Gradient and average information of the log-likelihood by log theta.
struct Slope {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

/// Sums over the poses that the slope is made of, for each component V_i = Z_i Z_i' (P is what C^-1 is beside the columns).
struct SlopeSums {
  explicit SlopeSums(Eigen::Index columns, Eigen::Index count)
      : trace(Eigen::VectorXd::Zero(count)),
        taken(trace),
        quadratic(trace),
        moved(Eigen::MatrixXd::Zero(count, count)),
        halved(Eigen::MatrixXd::Zero(columns, count)) {}
  Eigen::VectorXd trace;      ///< trace(C^-1 V_i)
  Eigen::VectorXd taken;      ///< trace(A^-1 X' C^-1 V_i C^-1 X)
  Eigen::VectorXd quadratic;  ///< r' P V_i P r
  Eigen::MatrixXd moved;      ///< r' P V_i C^-1 V_j P r
  Eigen::MatrixXd halved;     ///< F X' C^-1 V_i P r
};

void addPoses(const CondensedRows& rows, const Posterior& posterior, const WhitenedPoses& some, SlopeSums& sums) {
  const Eigen::Index columns = posterior.columns;
  const Eigen::MatrixXd X = some.Xr.leftCols(columns);
  const Eigen::VectorXd residual = some.Xr.col(columns) - X * posterior.estimate.b;
  const Eigen::MatrixXd halved = posterior.inverse.half(X.transpose());
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(some.Xr.rows(), sums.trace.size());
  Eigen::MatrixXd W, crossed;
  for (std::size_t g = some.begin; g < some.end; ++g) {
    const CondensedRows::Pose& pose = rows.poses[g];
    const Eigen::Index row = pose.begin - some.row;
    const Eigen::Index own = rows.white ? pose.size : 0;
    W.resize(pose.size, own + pose.Z.cols());
    const Eigen::MatrixXd& whitener = some.whitener[g - some.begin];
    W.leftCols(own) = whitener.leftCols(own);
    W.rightCols(pose.Z.cols()).noalias() = whitener * pose.Z;
    crossed.noalias() = halved.middleCols(row, pose.size) * W;
    const Eigen::VectorXd projected = W.transpose() * residual.segment(row, pose.size);
    Eigen::Index next = own;
    for (Eigen::Index i = 0; i < sums.trace.size(); ++i) {
      const bool is_white = static_cast<std::size_t>(i) == rows.white;
      const Eigen::Index begin = is_white ? 0 : next, width = is_white ? own : pose.width[static_cast<std::size_t>(i)];
      if (!is_white) next += width;
      sums.trace(i) += W.middleCols(begin, width).squaredNorm();
      sums.taken(i) += crossed.middleCols(begin, width).squaredNorm();
      sums.quadratic(i) += projected.segment(begin, width).squaredNorm();
      moved.col(i).segment(row, pose.size).noalias() = W.middleCols(begin, width) * projected.segment(begin, width);
    }
  }
  sums.moved.noalias() += moved.transpose() * moved;
  sums.halved.noalias() += halved * moved;
}

/// The rows beyond the spans, where C is theta I.
void addBeyond(const CondensedRows& rows, const Posterior& posterior, double theta, SlopeSums& sums) {
  const auto white = static_cast<Eigen::Index>(*rows.white);
  const Eigen::Index columns = posterior.columns;
  const Eigen::MatrixXd XX = rows.squares.topLeftCorner(columns, columns);
  const Eigen::VectorXd Xr = rows.squares.topRightCorner(columns, 1), &b = posterior.estimate.b;
  const double square = rows.squares(columns, columns) - 2.0 * b.dot(Xr) + b.dot(XX * b);  // of r - X b
  sums.trace(white) += rows.beyond / theta;
  sums.taken(white) += posterior.inverse.solve(XX).trace() / (theta * theta);
  sums.quadratic(white) += square / (theta * theta);
  sums.moved(white, white) += square / (theta * theta * theta);
  sums.halved.col(white) += posterior.inverse.half(Xr - XX * b) / (theta * theta);
}

Slope slopeOf(const CondensedRows& rows, const Posterior& posterior, const std::vector<NoiseComponent>& components) {
  const Eigen::VectorXd& theta = posterior.estimate.theta;
  SlopeSums sums(posterior.columns, theta.size());
  forWhitenedPoses(rows, theta, [&](const WhitenedPoses& some) { addPoses(rows, posterior, some, sums); });
  if (rows.white) addBeyond(rows, posterior, theta(static_cast<Eigen::Index>(*rows.white)), sums);
  Slope slope;
  slope.gradient = 0.5 * theta.cwiseProduct(sums.quadratic - (sums.trace - sums.taken));
  slope.information = 0.5 * (sums.moved - sums.halved.transpose() * sums.halved);
  slope.information = theta.asDiagonal() * slope.information * theta.asDiagonal();
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const VariancePrior prior = variancePrior(components[static_cast<std::size_t>(i)], theta(i));
    slope.gradient(i) -= prior.gradient;
    slope.information(i, i) += prior.curvature;
  }
  return slope;
}

/// The factor by which the arm exceeds its tolerances, from where it stands.
double toleranceThere(const MeasuredCell& measured, const ModelState& state, const Posterior& posterior) {
  const Eigen::Index twists = measured.twists.precision.rows();
  if (twists == 0) return 1.0;
  const Eigen::MatrixXd covariance = posterior.inverse.solve(Eigen::MatrixXd::Identity(posterior.columns, twists)).topRows(twists);
  return updatedTolerance(measured.twists, state.cell.beta + posterior.estimate.b.head(twists), covariance, posterior.estimate.tolerance);
}

/// An arm beyond its tolerances is believed less and less: a factor e costs two units of log-likelihood.
double tolerancePenalty(double tolerance) { return 2.0 * std::pow(std::log(tolerance), 2); }

/// All that is known at one set of variances, with what is believed of them.
Posterior posteriorAt(const CondensedRows& rows, const std::vector<NoiseComponent>& components, const Eigen::VectorXd& theta,
                      const ColumnPrior& prior, double tolerance) {
  Posterior posterior(normalOf(rows, theta), theta, prior);
  posterior.estimate.tolerance = tolerance;
  posterior.estimate.log_likelihood -= tolerancePenalty(tolerance);
  for (std::size_t i = 0; i < components.size(); ++i) {
    posterior.estimate.log_likelihood -= variancePrior(components[i], theta(static_cast<Eigen::Index>(i))).penalty;
  }
  return posterior;
}

}  // namespace

std::vector<NoiseComponent> noiseComponents(const MeasuredCell& measured, const CaptureRows& rows) {
  std::vector<NoiseComponent> components;
  const auto identity = [](const ObservationRows& part) { return Eigen::MatrixXd(Eigen::MatrixXd::Identity(part.size, part.size)); };
  const bool corners = measured.start.camera.has_value();
  if (corners) {
    components.push_back(component(rows, "corner", kStartCorner * kStartCorner, false, identity));
    components.back().white = true;
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
    components.back().white = !whole;
  }
  const bool arm =
      std::any_of(rows.observations.begin(), rows.observations.end(), [](const ObservationRows& p) { return p.ports.joints.cols() > 0; });
  if (arm) {
    components.push_back(component(rows, "repeatability", kStartRepeatability * kStartRepeatability, true,
                                   [&measured](const ObservationRows& part) { return jointColumns(measured, part); }));
  }
  if (arm && measured.rounding.size() > 0) {
    components.push_back(component(rows, kRoundedReadings, 1.0, true, [&measured](const ObservationRows& part) {
      return Eigen::MatrixXd(part.rows.H * part.ports.joints * measured.rounding.asDiagonal());
    }));
  }
  return components;
}

std::string scatterName(std::size_t k) { return fmt::format("scatter joint:{}", k + 1); }

std::vector<std::size_t> scatterOf(const std::vector<NoiseComponent>& components) {
  const std::string prefix = "scatter joint:";
  std::vector<std::size_t> joints;
  for (const NoiseComponent& each : components) {
    if (each.name.starts_with(prefix)) joints.push_back(std::stoul(each.name.substr(prefix.size())) - 1);
  }
  return joints;
}

NoiseComponent jointScatter(const CaptureRows& rows, std::size_t k, double start) {
  return component(rows, scatterName(k), start, true, [k](const ObservationRows& part) {
    return Eigen::MatrixXd(part.rows.H * part.ports.joints.col(static_cast<Eigen::Index>(k)));
  });
}

void factorNoise(const Eigen::MatrixXd& C, Eigen::LLT<Eigen::MatrixXd>& llt) {
  llt.compute(C);
  if (llt.info() == Eigen::Success) return;
  // Beside joints that are off by far, what the corners alone are off by is lost in rounding.
  constexpr double kRounding = 1e-13;
  const double lost = kRounding * C.trace();
  llt.compute(C + lost * Eigen::MatrixXd::Identity(C.rows(), C.cols()));
  if (llt.info() != Eigen::Success || !std::isfinite(lost)) {
    throw InsufficientData("the poses are so far from the model that their noise cannot be told");
  }
}

Whitening::Whitening(const CaptureRows& rows, const std::vector<NoiseComponent>& components, const Eigen::VectorXd& theta) {
  int begin = 0;
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    const int size = rows.groupSize(g);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t i = 0; i < components.size(); ++i) {
      const double variance = theta(static_cast<Eigen::Index>(i));
      if (components[i].white) {
        C.diagonal().array() += variance;
      } else if (components[i].Z[g].cols() > 0) {
        C.selfadjointView<Eigen::Lower>().rankUpdate(components[i].Z[g], variance);
      }
    }
    Eigen::LLT<Eigen::MatrixXd> llt;
    factorNoise(C, llt);
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

Eigen::MatrixXd rootOf(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

std::optional<double> varianceOf(const std::string& name, const std::vector<NoiseComponent>& components, const NoiseEstimate& noise) {
  const auto found = std::find_if(components.begin(), components.end(), [&name](const NoiseComponent& each) { return each.name == name; });
  if (found == components.end()) return {};
  return noise.theta(found - components.begin());
}

std::vector<NoiseEstimate> likelihoodsAt(const CaptureRows& rows, const std::vector<NoiseComponent>& components,
                                         const Eigen::VectorXd& theta, const Eigen::MatrixXd& extra,
                                         const std::vector<ColumnPrior>& priors) {
  const Normal normal = normalOf(CondensedRows(rows, components, extra), theta);
  std::vector<NoiseEstimate> estimates;
  for (const ColumnPrior& prior : priors) {
    Posterior posterior(normal, theta, prior);
    posterior.estimate.covariance = posterior.covariance();
    estimates.push_back(std::move(posterior.estimate));
  }
  return estimates;
}

NoiseEstimate estimateNoise(const MeasuredCell& measured, const ModelState& state, const CaptureRows& rows,
                            const std::vector<NoiseComponent>& components, const Eigen::MatrixXd& extra, const ColumnPrior& extra_prior,
                            const NoiseEstimate* from, double precision) {
  const CondensedRows condensed(rows, components, extra);
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
  std::optional<Posterior> best;
  constexpr int kMaxSteps = 40;
  for (int step = 0; step < kMaxSteps; ++step) {
    Posterior here = posteriorAt(condensed, components, theta, basePrior(measured, state, tolerance).joinedWith(extra_prior), tolerance);
    const double gain = best ? here.estimate.log_likelihood - best->estimate.log_likelihood : 1.0;
    if (best && gain < -1e-9) {
      damping *= 10.0;
      if (damping > 1e6) break;
    } else {
      const bool settled = best && gain < precision;
      best = std::move(here);
      if (settled) break;
      damping = std::max(1e-6, 0.1 * damping);
    }
    Slope slope = slopeOf(condensed, *best, components);
    slope.information.diagonal().array() += damping * (slope.information.diagonal().array() + 1.0);
    Eigen::VectorXd move = slope.information.ldlt().solve(slope.gradient);
    if (!move.allFinite()) break;
    move = move.cwiseMax(-3.0).cwiseMin(3.0);
    theta = (best->estimate.theta.array() * move.array().exp()).matrix().cwiseMax(floor);
    tolerance = toleranceThere(measured, state, *best);
  }
  NoiseEstimate estimate = std::move(best->estimate);
  estimate.covariance = best->covariance();
  return estimate;
}

}  // namespace poecal
