#include "diagnosis/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "diagnosis/refit.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/registration/target_pose.hpp"

namespace poecal {
namespace {

/// What a pose is off, from its rows: they know of curves too, which are in no port.
Vector6d poseError(const PoseMeasurement& pose, const Eigen::VectorXd& r) {
  Vector6d e = Vector6d::Zero();
  if (!pose.whitening.isZero(0.0)) e.tail(r.size()) = pose.whitening.bottomRightCorner(r.size(), r.size()).partialPivLu().solve(r);
  return e;
}

/// Sums of a rung and of the last one over some poses.
struct Sums {
  double squares = 0.0, last_squares = 0.0, last_expected = 0.0, points = 0.0;
  void add(const PoseErrors& pose, const PoseErrors& last, double expected) {
    squares += pose.squares;
    last_squares += last.squares;
    last_expected += expected;
    points += pose.points;
  }
  /// Mean square above the noise. Where chance makes it less than that of the last, a quarter of that: who takes away what helps does not
  /// come out with nothing.
  double excess() const { return points > 0.0 ? std::max(squares - last_squares + last_expected, 0.25 * last_expected) / points : 0.0; }
  /// 1 - excess of the last / excess, as roots.
  double shrinkage() const { return excess() > 0.0 ? 1.0 - std::sqrt(last_expected / points / excess()) : 0.0; }
};

/// Squares of each pose that the uncertainty of a fit to all others makes: with P = X Cov X' of the pose by the whole fit and C its noise,
/// leaving it out gives P + P (C - P)^-1 P.
std::vector<double> expectedSquares(const Linearised& linear, const Eigen::MatrixXd& X, const Eigen::VectorXd& weights) {
  const Whitening whitening(linear.rows, linear.components, linear.noise.theta);
  std::vector<double> squares;
  for (std::size_t g = 0; g < whitening.poses(); ++g) {
    const int begin = whitening.begin(g), size = whitening.size(g);
    const Eigen::MatrixXd part = X.middleRows(begin, size);
    const Eigen::MatrixXd P = part * linear.noise.covariance * part.transpose();
    // Its eigenvalues lie between 0 and 1.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> share(whitening.applyTo(g, whitening.applyTo(g, P).transpose()));
    constexpr double kMost = 0.99;  // a pose that alone tells of something tells nothing of how well others know it
    const Eigen::ArrayXd taken = share.eigenvalues().array().max(0.0).min(kMost);
    const Eigen::MatrixXd directions = whitening.undo(g, share.eigenvectors());
    const Eigen::VectorXd variances = directions.cwiseAbs2() * (taken / (1.0 - taken)).matrix();
    squares.push_back(variances.dot(weights.segment(begin, size)));
  }
  return squares;
}

/// Squares that the parameters make at each pose when they are drawn from their covariance, poses x draws; their mean is `expected`.
Eigen::MatrixXd drawnSquares(const Linearised& linear, const Eigen::MatrixXd& X, const Eigen::VectorXd& weights,
                             const std::vector<double>& expected, int draws, Rng& rng) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> covariance(linear.noise.covariance);
  const Eigen::MatrixXd root = covariance.eigenvectors() * covariance.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd moved = weights.cwiseSqrt().asDiagonal() * (X * root);
  const Eigen::MatrixXd errors = Eigen::MatrixXd::NullaryExpr(moved.cols(), draws, [&rng] { return rng.normal(); });
  Eigen::MatrixXd squares(static_cast<Eigen::Index>(expected.size()), draws);
  Eigen::Index begin = 0;
  for (std::size_t g = 0; g < expected.size(); ++g) {
    const int size = linear.rows.groupSize(g);
    const auto part = moved.middleRows(begin, size);
    // What the fit saw of the pose makes it better known than it is to a fit that did not.
    const double unseen = expected[g] / std::max(part.squaredNorm(), std::numeric_limits<double>::min());
    squares.row(static_cast<Eigen::Index>(g)) = unseen * (part * errors).colwise().squaredNorm();
    begin += size;
  }
  return squares;
}

/// Squares that poses of other times keep of what a slip takes away, as a share of that: those that stand on the wrong side of it. When it
/// was is known to lie between two pictures.
struct SlipTime {
  double wrong = 0.0;  ///< chance that a pose is on the wrong side
  double share = 0.0;  ///< of such a pose, in units of the mean over all

  /// @param time  where it was taken to be.
  SlipTime(double time, const std::vector<Sample>& samples) {
    double first = std::numeric_limits<double>::infinity(), last = -first, before = -first, after = first;
    std::size_t early = 0;
    for (const Sample& sample : samples) {
      const double stamp = sample.stamp.value_or(time);
      first = std::min(first, stamp);
      last = std::max(last, stamp);
      if (stamp < time) {
        before = std::max(before, stamp);
        ++early;
      } else {
        after = std::min(after, stamp);
      }
    }
    if (early == 0 || early == samples.size()) return;
    // It is anywhere between the two, a pose is too, and it was taken to be in the middle.
    wrong = 0.25 * (after - before) / (last - first);
    // Who does not know of it is off by a share of it everywhere; who has the wrong side, by all of it.
    const double share_before = static_cast<double>(early) / static_cast<double>(samples.size());
    share = 1.0 / (share_before * (1.0 - share_before));
  }
  double draw(std::size_t poses, Rng& rng) const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < poses; ++k) count += rng.uniform() < wrong ? 1 : 0;
    return share * static_cast<double>(count) / static_cast<double>(poses);
  }
};

std::vector<SlipTime> slipTimes(const Selection& selection) {
  std::vector<SlipTime> slips;
  for (const Accepted& one : selection.linear.accepted) {
    if (const auto time = one.candidate.slipTime()) slips.emplace_back(one.candidate.parameters(*time), selection.measured.samples);
  }
  return slips;
}

/// The noise as `identify` sees it, which takes all of it for single corners' own, and the arm for one that keeps its tolerances: the same
/// in all corners, and of the same mean square.
NoiseEstimate asCornerNoise(const Linearised& linear) {
  const auto corner = std::find_if(linear.components.begin(), linear.components.end(), [](const auto& c) { return c.white; });
  if (corner == linear.components.end()) return linear.noise;
  double squares = 0.0;
  for (std::size_t i = 0; i < linear.components.size(); ++i) {
    for (const Eigen::MatrixXd& Z : linear.components[i].Z) squares += linear.noise.theta(static_cast<Eigen::Index>(i)) * Z.squaredNorm();
  }
  NoiseEstimate white = linear.noise;
  white.tolerance = 1.0;
  white.theta.setZero();
  white.theta(corner - linear.components.begin()) = squares / linear.rows.size();
  return white;
}

}  // namespace

Ladder::Ladder(const Selection& selection, const Registration& closed_form, int folds, std::uint64_t seed)
    : selection_(selection), closed_form_(closed_form), resampling_(seed, 1) {
  const Eigen::MatrixXd X = selection.linear.allColumns();
  const Eigen::VectorXd weights = squareWeights(selection.linear.rows);
  expected_ = expectedSquares(selection.linear, X, weights);
  constexpr int kDraws = 400;
  if (!selection.findings.empty()) drawn_ = drawnSquares(selection.linear, X, weights, expected_, kDraws, resampling_);
  const std::size_t groups = selection.measured.groups.size();
  std::vector<std::size_t> order(groups);
  std::iota(order.begin(), order.end(), 0);
  Rng rng(seed);
  for (std::size_t k = groups; k > 1; --k) std::swap(order[k - 1], order[rng.below(k)]);
  const auto count = std::min(groups, static_cast<std::size_t>(std::max(2, folds)));
  folds_.resize(count);
  for (std::size_t k = 0; k < groups; ++k) folds_[k % count].push_back(order[k]);
  for (std::vector<std::size_t>& fold : folds_) std::sort(fold.begin(), fold.end());
}

void Ladder::addErrors(const Linearised& at, const Groups& test, const std::vector<std::size_t>& numbers, Rung& rung) const {
  for (std::size_t g = 0; g < test.size(); ++g) {
    PoseErrors& pose = rung.poses[numbers[g]];
    for (const std::size_t k : at.rows.groups[g]) {
      const ObservationRows& part = at.rows.observations[k];
      const Observation& observation = selection_.measured.observations[part.context.number];
      if (observation.pose) {
        const Vector6d e = poseError(*observation.pose, at.rows.r.segment(part.begin, part.size));
        pose.squares += e.tail<3>().squaredNorm();
        pose.points += 1.0;
        pose.position += e.tail<3>().squaredNorm();
        if (!observation.pose->position_only) pose.rotation += e.head<3>().squaredNorm();
        pose.targets += 1.0;
        continue;
      }
      const Eigen::VectorXd r = at.rows.r.segment(part.begin, part.size);
      for (std::size_t j = 0; j < part.unit_sigma.size(); ++j) {
        if (!part.rows.valid[j]) continue;
        pose.squares += r.segment<2>(2 * static_cast<Eigen::Index>(j)).squaredNorm() * part.unit_sigma[j] * part.unit_sigma[j];
        pose.points += 1.0;
      }
      constexpr std::size_t kOfAPose = 4;  // corners that a pose of its own takes
      if (observation.corners.size() < kOfAPose) continue;
      const PlainSight plain = plainSight(selection_.measured, at.state, part);
      const FreePose free = refinePose(*plain.cell.camera, plain.observation, part.ports.T_camera_target);
      const Registration& registration = at.state.cell.cell.registration;
      const Vector6d e = poseDifference(registration.baseFlange(free.T_camera_target), registration.baseFlange(part.ports.T_camera_target));
      pose.position += e.tail<3>().squaredNorm();
      pose.rotation += e.head<3>().squaredNorm();
      pose.targets += 1.0;
    }
  }
}

template <typename Fit>
Rung Ladder::judged(const std::string& stage, Fit fit) const {
  const Groups& groups = selection_.measured.groups;
  Rung rung{stage, std::vector<PoseErrors>(groups.size())};
  for (const std::vector<std::size_t>& fold : folds_) {
    Groups train, test;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      (std::binary_search(fold.begin(), fold.end(), g) ? test : train).push_back(groups[g]);
    }
    const Fitted model = fit(train);
    addErrors(linearise(selection_.measured, model.state, model.accepted, {}, test), test, fold, rung);
  }
  return rung;
}

std::vector<Rung> Ladder::geometricRungs() const {
  const MeasuredCell& measured = selection_.measured;
  ModelState nominal{CellState(measured.start, measured.free), {}};
  nominal.cell.cell.registration = closed_form_;
  std::vector<Rung> rungs;
  rungs.push_back(judged("nominal", [&](const Groups&) { return Fitted{nominal, {}}; }));
  rungs.push_back(judged("registered", [&](const Groups& train) {
    std::vector<Observation> some;
    for (const std::vector<std::size_t>& group : train) {
      for (const std::size_t k : group) some.push_back(measured.observations[k]);
    }
    AdjustmentOptions options;
    options.free = {.near = measured.free.near, .far = measured.free.far};
    ModelState state{CellState(measured.start, measured.free), {}};
    if (options.free.near) state.cell.cell = adjust(measured.start, some, options).cell;
    return Fitted{state, {}};
  }));
  rungs.push_back(fitted("identified", selection_.base, {}, {}, asCornerNoise(selection_.linear)));
  return rungs;
}

Rung Ladder::fitted(const std::string& stage, const ModelState& start, const std::vector<Accepted>& accepted,
                    const std::vector<std::size_t>& scatter, const NoiseEstimate& noise) const {
  return judged(stage, [&](const Groups& train) {
    const Linearised linear = refit(selection_.measured, start, accepted, scatter, noise, train, false);
    return Fitted{linear.state, linear.accepted};
  });
}

Rung Ladder::rungWith(const std::string& stage, const std::vector<std::size_t>& findings) const {
  std::vector<Accepted> accepted;
  std::vector<std::size_t> scatter;
  for (const std::size_t i : findings) {
    const FoundEffect& found = selection_.findings[i];
    if (found.accepted) accepted.push_back(*found.accepted);
    if (found.scatter) scatter.push_back(*found.scatter);
  }
  const bool whole = findings.size() == selection_.findings.size();
  const ModelState& start = whole ? selection_.linear.state : selection_.base;
  const auto all_scatter = std::count_if(selection_.findings.begin(), selection_.findings.end(), [](const auto& f) { return f.scatter; });
  // What a single pose is worth does not hang on which rung it judges: the noise is that of the whole model.
  if (static_cast<std::ptrdiff_t>(scatter.size()) == all_scatter) return fitted(stage, start, accepted, scatter, selection_.linear.noise);
  // A joint that moves at random is noise itself: who does not know of it takes it for that of all joints.
  const Linearised without = refit(selection_.measured, start, accepted, scatter, selection_.base_noise, {}, true);
  return fitted(stage, start, accepted, scatter, without.noise);
}

GapStage Ladder::stageOf(const Rung& rung, const Rung& last) const {
  PoseErrors sum;
  Sums sums;
  for (std::size_t g = 0; g < rung.poses.size(); ++g) {
    const PoseErrors& pose = rung.poses[g];
    sum.position += pose.position;
    sum.rotation += pose.rotation;
    sum.targets += pose.targets;
    sums.add(pose, last.poses[g], expected_[g]);
  }
  GapStage stage;
  stage.stage = rung.stage;
  stage.rms = sums.points > 0.0 ? std::sqrt(sums.squares / sums.points) : 0.0;
  stage.excess = std::sqrt(sums.excess());
  stage.position = sum.targets > 0.0 ? std::sqrt(sum.position / sum.targets) : 0.0;
  stage.rotation = sum.targets > 0.0 ? std::sqrt(sum.rotation / sum.targets) : 0.0;
  return stage;
}

Shrinkage Ladder::shrinkage(const Rung& before, const Rung& last) const {
  constexpr int kResamples = 2000;
  constexpr std::size_t kTestPoses = 60;
  const std::size_t count = before.poses.size();
  Sums all;
  for (std::size_t g = 0; g < count; ++g) all.add(before.poses[g], last.poses[g], expected_[g]);
  Shrinkage shrinkage;
  if (!(all.points > 0.0)) return shrinkage;
  shrinkage.value = all.shrinkage();
  Rng rng = resampling_;
  // These poses are a sample, and so are those on which somebody looks again: both means scatter, as one over so many poses does.
  const std::size_t again = std::min<std::size_t>(count, kTestPoses), others = std::max<std::size_t>(1, count * again / (count + again));
  const std::vector<SlipTime> slips = slipTimes(selection_);
  const bool any_shape =
      std::any_of(selection_.findings.begin(), selection_.findings.end(), [](const FoundEffect& found) { return found.name == "unknown"; });
  std::vector<double> values;
  for (int resample = 0; resample < kResamples; ++resample) {
    Sums sums;
    for (std::size_t k = 0; k < others; ++k) {
      const std::size_t g = rng.below(count);
      sums.add(before.poses[g], last.poses[g], drawn_(static_cast<Eigen::Index>(g), resample % drawn_.cols()));
    }
    double kept = 0.0;
    for (const SlipTime& slip : slips) kept += slip.draw(kTestPoses, rng);
    // Waves follow some shapes that nobody knows as far as their covariance says, and others only so far: in the withheld world a twentieth
    // of what they take away comes back elsewhere in one capture of four, an eighth in one of ten.
    constexpr double kFollowed = 0.5, kMisfit = 0.05;
    if (any_shape && rng.uniform() > kFollowed) kept += kMisfit * std::exp(rng.normal());
    sums.last_expected += kept * std::max(0.0, sums.squares - sums.last_squares);
    values.push_back(sums.shrinkage());
  }
  shrinkage.interval = {quantile(values, 0.025), quantile(values, 0.975)};
  return shrinkage;
}

double Ladder::gain(const Rung& before, const Rung& last) const {
  double sum = 0.0, squares = 0.0;
  for (std::size_t g = 0; g < before.poses.size(); ++g) {
    const double gain = before.poses[g].squares - last.poses[g].squares;
    sum += gain;
    squares += gain * gain;
  }
  const double variance = squares - sum * sum / static_cast<double>(before.poses.size());
  return variance > 0.0 ? sum / std::sqrt(variance) : 0.0;
}

double Ladder::noiseRms(const Rung& last) const {
  Sums sums;
  for (std::size_t g = 0; g < last.poses.size(); ++g) sums.add(last.poses[g], last.poses[g], expected_[g]);
  return sums.points > 0.0 ? std::sqrt(std::max(0.0, sums.last_squares - sums.last_expected) / sums.points) : 0.0;
}

}  // namespace poecal
