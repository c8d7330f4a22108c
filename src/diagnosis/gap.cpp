#include "diagnosis/gap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// Sums over some poses.
struct Sums {
  double before = 0.0, after = 0.0, expected = 0.0, fewer = 0.0, points = 0.0;
  /// @param by_covariance  squares that a fit to all other poses is off by. @param by_fewer  what one without the pose's fold is off by
  /// more.
  void add(const PoseSquares& one, const PoseSquares& other, double by_covariance, double by_fewer) {
    before += one.squares;
    after += other.squares;
    expected += by_covariance;
    fewer += by_fewer;
    points += one.points;
  }
  /// Mean square after, as a fit to all other poses would have left it.
  double left() const { return (after - fewer) / points; }
  /// 1 - excess after / excess before, as roots. @param excess  mean square of that after. Where chance makes that of before less than
  /// that of after, a quarter of it: who takes away what helps does not come out with nothing.
  double shrinkage(double excess) const {
    const double there = std::max((before - after) / points + excess, 0.25 * excess);
    return there > 0.0 ? 1.0 - std::sqrt(excess / there) : 0.0;
  }
};

/// What a fit may be off by: its columns times R, R R' the covariance of its parameters, and the noise of its poses.
struct Uncertainty {
  explicit Uncertainty(const Linearised& linear)
      : moves(linear.allColumns() * rootOf(linear.noise.covariance)),
        weights(squareWeights(linear.rows)),
        whitening(linear.rows, linear.components, linear.noise.theta) {}
  auto movesOf(std::size_t g) const { return moves.middleRows(whitening.begin(g), whitening.size(g)); }
  auto weightsOf(std::size_t g) const { return weights.segment(whitening.begin(g), whitening.size(g)); }

  Eigen::MatrixXd moves;
  Eigen::VectorXd weights;
  Whitening whitening;
};

/// Squares of each pose that the uncertainty of a fit without its fold makes. With C = L L' the noise, M the moves of the fold and
/// B = M' L'^-1, leaving it out makes the covariance of the fold's rows M (1 - B B')^-1 M'.
std::vector<double> squaresWithout(const Folds& folds, const Uncertainty& fit) {
  std::vector<double> squares(fit.whitening.poses());
  for (const std::vector<std::size_t>& fold : folds) {
    if (fold.empty()) continue;  // all its poses were set aside
    Eigen::Index size = 0;
    for (const std::size_t g : fold) size += fit.whitening.size(g);
    Eigen::MatrixXd B(fit.moves.cols(), size);
    Eigen::Index begin = 0;
    for (const std::size_t g : fold) {
      B.middleCols(begin, fit.whitening.size(g)) = fit.whitening.applyTo(g, fit.movesOf(g)).transpose();
      begin += fit.whitening.size(g);
    }
    // Of B B' and B' B the smaller one; the eigenvalues of either that are not 0 lie between 0 and 1.
    const bool thin = B.cols() < B.rows();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> share(thin ? Eigen::MatrixXd(B.transpose() * B)
                                                                    : Eigen::MatrixXd(B * B.transpose()));
    constexpr double kMost = 0.99;  // a fold that alone tells of something tells nothing of how well others know it
    const Eigen::ArrayXd taken = share.eigenvalues().array().max(0.0).min(kMost);
    const Eigen::ArrayXd left = 1.0 - taken;
    const Eigen::MatrixXd directions = thin ? Eigen::MatrixXd(B * share.eigenvectors()) : share.eigenvectors();
    const Eigen::VectorXd more = thin ? Eigen::VectorXd(left.inverse()) : Eigen::VectorXd(taken / left);
    for (const std::size_t g : fold) {
      const Eigen::VectorXd variances = fit.movesOf(g).rowwise().squaredNorm() + (fit.movesOf(g) * directions).cwiseAbs2() * more;
      squares[g] = variances.dot(fit.weightsOf(g));
    }
  }
  return squares;
}

Folds eachAlone(std::size_t poses) {
  Folds folds;
  for (std::size_t g = 0; g < poses; ++g) folds.push_back({g});
  return folds;
}

/// Squares that the parameters make at each pose when they are drawn from their covariance, poses x draws; their mean is `expected`.
Eigen::MatrixXd drawnSquares(const Uncertainty& fit, const std::vector<double>& expected, int draws, Rng& rng) {
  const Eigen::MatrixXd errors = Eigen::MatrixXd::NullaryExpr(fit.moves.cols(), draws, [&rng] { return rng.normal(); });
  Eigen::MatrixXd squares(static_cast<Eigen::Index>(expected.size()), draws);
  for (std::size_t g = 0; g < expected.size(); ++g) {
    const Eigen::MatrixXd part = fit.weightsOf(g).cwiseSqrt().asDiagonal() * fit.movesOf(g);
    // What the fit saw of the pose makes it better known than it is to a fit that did not.
    const double unseen = expected[g] / std::max(part.squaredNorm(), std::numeric_limits<double>::min());
    squares.row(static_cast<Eigen::Index>(g)) = unseen * (part * errors).colwise().squaredNorm();
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

double meanSquare(const Rung& rung) {
  double squares = 0.0, points = 0.0;
  for (const PoseSquares& pose : rung.poses) {
    squares += pose.squares;
    points += pose.points;
  }
  return points > 0.0 ? squares / points : 0.0;
}

bool hasAnyShape(const Selection& selection) {
  return std::any_of(selection.findings.begin(), selection.findings.end(), [](const FoundEffect& found) { return found.isUnknown(); });
}

/// How far what is measured is from what was expected counts as more than chance: 0 for less than one standard deviation of it, nearly 1
/// beyond three.
double beyondChance(double more, double sigma) {
  if (!(more > 0.0)) return 0.0;
  const double square = more * more;
  return square / (square + sigma * sigma);
}

std::pair<double, double> middle(std::vector<double>& values) { return {quantile(values, 0.025), quantile(values, 0.975)}; }

/// Squares that each pose is better off by.
std::vector<double> gainsOf(const Rung& before, const Rung& after) {
  std::vector<double> gains;
  for (std::size_t g = 0; g < before.poses.size(); ++g) {
    gains.push_back(before.whitened.empty() ? before.poses[g].squares - after.poses[g].squares : before.whitened[g] - after.whitened[g]);
  }
  return gains;
}

constexpr int kResamples = 2000;
constexpr std::size_t kTestPoses = 60;

/// These poses are a sample, and so are those on which somebody looks again: the difference of both means scatters as one mean over so
/// many poses does.
std::size_t posesOfBoth(std::size_t count) {
  const std::size_t again = std::min(count, kTestPoses);
  return std::max<std::size_t>(1, count * again / (count + again));
}

}  // namespace

Gap::Gap(const Selection& selection, const MeasurementNoise& noise, const std::vector<Rung>& rungs, const Folds& folds, std::uint64_t seed)
    : selection_(selection), noise_(noise), last_(rungs.back()), resampling_(seed, 1) {
  const Uncertainty fit(selection.linear);
  expected_ = squaresWithout(eachAlone(fit.whitening.poses()), fit);
  fewer_ = squaresWithout(folds, fit);
  for (std::size_t g = 0; g < fewer_.size(); ++g) fewer_[g] -= expected_[g];
  constexpr int kDraws = 400;
  drawn_ = drawnSquares(fit, expected_, kDraws, resampling_);
  lowest_ = std::numeric_limits<double>::infinity();
  for (const Rung& rung : rungs) lowest_ = std::min(lowest_, meanSquare(rung));
  Sums sums;
  for (std::size_t g = 0; g < last_.poses.size(); ++g) sums.add(last_.poses[g], last_.poses[g], expected_[g], fewer_[g]);
  if (!(sums.points > 0.0)) return;
  const double after = sums.after / sums.points, expected = sums.expected / sums.points;
  const double more = std::max(0.0, sums.left() - noise_.least - expected);
  const double excess = expected + more * beyondChance(more, noise_.chance * noise_.least);
  // What the fit may be off by takes nothing from noise that is known, and adds nothing to it.
  constexpr double kSurely = 3.0;
  const double surely = noise_.least * std::max(0.0, 1.0 - kSurely * noise_.chance);
  const double at_most = std::min(lowest_, noise_.least * (1.0 + kSurely * noise_.chance));
  subtracted_ = std::clamp(after - excess, std::min(surely, at_most), at_most);
  unexplained_ = beyondChance(sums.left() - noise_.random - expected, noise_.chance * noise_.random);
}

GapStage Gap::stageOf(const Rung& rung) const {
  GapStage stage;
  stage.stage = rung.stage;
  stage.errors = rung.every_row;
  stage.rms = std::sqrt(meanSquare(rung));
  stage.rms_interval = rmsInterval(rung.poses);
  stage.excess = std::sqrt(std::max(0.0, meanSquare(rung) - subtracted_));
  if (!(stage.excess <= stage.rms) || !(noiseRms() <= stage.rms)) {
    throw std::logic_error("the noise told is larger than what poses that a fit did not see are off by");
  }
  return stage;
}

double Gap::noiseRms() const { return std::sqrt(subtracted_); }

std::pair<double, double> Gap::noiseBounds() const {
  // What it came to on these poses is one of the values that it may have.
  return {std::sqrt(std::min(noise_.least, subtracted_)), std::sqrt(std::max(std::min(noise_.most, lowest_), subtracted_))};
}

std::pair<double, double> Gap::remaining() const {
  const std::size_t count = last_.poses.size(), others = posesOfBoth(count);
  Rng rng = resampling_;
  const auto add = [&](int resample, Sums& sums) {
    const std::size_t g = rng.below(count);
    sums.add(last_.poses[g], last_.poses[g], drawn_(static_cast<Eigen::Index>(g), resample % drawn_.cols()), fewer_[g]);
  };
  std::vector<double> least, most;
  for (int resample = 0; resample < kResamples; ++resample) {
    Sums here, elsewhere;
    for (std::size_t k = 0; k < count; ++k) add(resample, here);
    for (std::size_t k = 0; k < others; ++k) add(resample, elsewhere);
    if (!(here.points > 0.0) || !(elsewhere.points > 0.0)) return {0.0, 0.0};
    const double after = std::max(0.0, here.left()), expected = std::min(after, elsewhere.expected / elsewhere.points);
    const double chance = noise_.chance * rng.normal();
    most.push_back(std::sqrt(std::clamp(after - noise_.least * (1.0 + chance), expected, after)));
    least.push_back(std::sqrt(std::clamp(after - noise_.random * (1.0 + chance), expected, after)));
  }
  const double told = std::sqrt(std::max(0.0, meanSquare(last_) - subtracted_));
  return {std::min(told, middle(least).first), std::max(told, middle(most).second)};
}

Gap::Drawn Gap::drawn(const Rung& before, const Rung& after) const {
  const std::size_t count = before.poses.size(), others = posesOfBoth(count);
  Rng rng = resampling_;
  const std::vector<SlipTime> slips = slipTimes(selection_);
  const bool any_shape = hasAnyShape(selection_);
  Drawn drawn;
  for (int resample = 0; resample < kResamples; ++resample) {
    Sums sums;
    for (std::size_t k = 0; k < others; ++k) {
      const std::size_t g = rng.below(count);
      sums.add(before.poses[g], after.poses[g], drawn_(static_cast<Eigen::Index>(g), resample % drawn_.cols()), fewer_[g]);
    }
    double kept = 0.0;
    for (const SlipTime& slip : slips) kept += slip.draw(kTestPoses, rng);
    // Waves follow some shapes that nobody knows as far as their covariance says, and others only so far: in the withheld world a twentieth
    // of what they take away comes back elsewhere in one capture of four, an eighth in one of ten.
    constexpr double kFollowed = 0.5, kMisfit = 0.05;
    if (any_shape && rng.uniform() > kFollowed) kept += kMisfit * std::exp(rng.normal());
    kept *= std::max(0.0, sums.before - sums.after) / sums.points;
    const double mean = sums.left(), expected = sums.expected / sums.points;
    // It is chance or it is not: half of it is neither.
    const double more = rng.uniform() < unexplained_ ? std::max(0.0, mean - noise_.random - expected) : 0.0;
    drawn.foretold.push_back(sums.shrinkage(expected + more + kept));
    drawn.measured.push_back(sums.shrinkage(std::max(expected, mean - noise_.least * (1.0 + noise_.chance * rng.normal())) + kept));
  }
  return drawn;
}

Shrinkage Gap::shrinkage(const Rung& before, const Rung& after, const std::vector<RungPair>& blocks,
                         const std::optional<Rung>& kept) const {
  Shrinkage shrinkage;
  Sums all;
  for (std::size_t g = 0; g < before.poses.size(); ++g) all.add(before.poses[g], after.poses[g], expected_[g], fewer_[g]);
  if (!(all.points > 0.0)) return shrinkage;
  shrinkage.value = all.shrinkage(std::max(0.0, meanSquare(after) - subtracted_));
  Drawn judged = drawn(before, after);
  shrinkage.interval = {std::min(middle(judged.foretold).first, middle(judged.measured).first), middle(judged.foretold).second};
  if (kept) {
    Drawn best = drawn(before, *kept);
    shrinkage.interval.second = std::max(shrinkage.interval.second, middle(best.foretold).second);
  }
  for (const RungPair& block : blocks) shrinkage.interval.first = std::min(shrinkage.interval.first, lowerEnd(block));
  shrinkage.value = std::clamp(shrinkage.value, shrinkage.interval.first, shrinkage.interval.second);
  return shrinkage;
}

double Gap::lowerEnd(const RungPair& rungs) const {
  const std::size_t count = rungs.before.poses.size();
  Rng rng = resampling_;
  std::vector<double> values;
  for (int resample = 0; resample < kResamples; ++resample) {
    Sums sums;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t g = rng.below(count);
      sums.add(rungs.before.poses[g], rungs.after.poses[g], expected_[g], 0.0);
    }
    const double noise = noise_.least * (1.0 + noise_.chance * rng.normal());
    values.push_back(sums.shrinkage(std::max(sums.expected, sums.after - sums.points * noise) / sums.points));
  }
  return quantile(values, 0.025);
}

double rmsOf(const Rung& rung) { return std::sqrt(meanSquare(rung)); }

double errorOf(const Rung& rung) { return rung.whitened.empty() ? rmsOf(rung) : std::sqrt(mean(rung.whitened)); }

double gain(const Rung& before, const Rung& after) {
  const std::vector<double> gains = gainsOf(before, after);
  double sum = 0.0, squares = 0.0;
  for (const double one : gains) {
    sum += one;
    squares += one * one;
  }
  const double variance = squares - sum * sum / static_cast<double>(gains.size());
  return variance > 0.0 ? sum / std::sqrt(variance) : 0.0;
}

double lostShare(const Rung& before, const Rung& after) {
  double gained = 0.0, lost = 0.0;
  for (const double one : gainsOf(before, after)) (one > 0.0 ? gained : lost) += std::abs(one);
  return gained > 0.0 ? lost / gained : std::numeric_limits<double>::infinity();
}

}  // namespace poecal
