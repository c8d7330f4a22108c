#include "diagnosis/smooth_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include <Eigen/Eigenvalues>

#include "diagnosis/thresholds.hpp"
#include "poecal/core/parallel.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

// Radians over which a field is much the same: a joint seldom turns by more than a few of the longest, and eighty poses cannot show less
// than the shortest.
constexpr std::array kLengths{0.5, 1.0, 2.0};
// Poses beyond these add little to which joints and which length it is.
constexpr Eigen::Index kMostPoses = 160;

/// Sets of joints whose angles a field may be over: pairs, threes and all of some; each kind has the same share.
constexpr double kKinds = 3.0;
using Joints = std::vector<std::size_t>;

double logShareOf(const Joints& set, std::size_t among) {
  const auto n = static_cast<double>(among);
  const double alike = set.size() == 2 ? n * (n - 1) / 2 : set.size() == 3 ? n * (n - 1) * (n - 2) / 6 : 1.0;
  return -std::log(kKinds * alike * static_cast<double>(kLengths.size()));
}

double readingOf(const ObservationRows& part, std::size_t joint) { return part.context.sample.q(static_cast<Eigen::Index>(joint)); }

/// The turns of a joint in some poses as the rows see them.
struct Turns {
  Eigen::MatrixXd q;            ///< one row a pose
  Eigen::MatrixXd information;  ///< J
  Eigen::VectorXd score;        ///< u
};

Turns turnsOf(const PortSums& port, const Linearised& linear) {
  const CaptureRows& rows = linear.rows;
  const auto poses = static_cast<Eigen::Index>(rows.groups.size()), stride = (poses + kMostPoses - 1) / kMostPoses;
  const Eigen::Index count = (poses + stride - 1) / stride;
  Turns turns{Eigen::MatrixXd(count, rows.observations.front().context.sample.q.size()), {}, Eigen::VectorXd(count)};
  Eigen::MatrixXd cross(port.cross.rows(), count);
  Eigen::VectorXd weight(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index g = i * stride;
    turns.q.row(i) = rows.observations[rows.groups[static_cast<std::size_t>(g)].front()].context.sample.q;
    cross.col(i) = port.cross.col(g);
    weight(i) = port.weight(g);
    turns.score(i) = port.residual(g) - port.cross.col(g).dot(linear.noise.b);
  }
  turns.information = -cross.transpose() * linear.noise.covariance * cross;
  turns.information.diagonal() += weight;
  return turns;
}

Joints turningJoints(const Linearised& linear) {
  const Arm& arm = *linear.state.cell.cell.arm;
  Joints turning;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const auto [low, high] =
        std::minmax_element(linear.rows.observations.begin(), linear.rows.observations.end(),
                            [k](const ObservationRows& a, const ObservationRows& b) { return readingOf(a, k) < readingOf(b, k); });
    if (arm.joints[k].type == JointType::kRevolute && readingOf(*high, k) - readingOf(*low, k) > kSearch.still) turning.push_back(k);
  }
  return turning;
}

/// L with L L' the kernel at the poses, but for what no pose would show: pivoted Cholesky.
Eigen::MatrixXd kernelFactor(const Eigen::MatrixXd& q, const Joints& joints, double length) {
  constexpr double kNothing = 1e-3;
  const Eigen::Index poses = q.rows();
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(poses, poses);
  for (const std::size_t k : joints) {
    const auto angles = q.col(static_cast<Eigen::Index>(k));
    squares.array() += (angles.replicate(1, poses).rowwise() - angles.transpose()).array().square();
  }
  const Eigen::MatrixXd kernel = (squares / (-2.0 * length * length)).array().exp();
  Eigen::VectorXd left = Eigen::VectorXd::Ones(poses);
  Eigen::MatrixXd L(poses, poses);
  Eigen::Index count = 0;
  for (Eigen::Index pivot = 0; count < poses && left.maxCoeff(&pivot) > kNothing; ++count) {
    L.col(count) = (kernel.col(pivot) - L.leftCols(count) * L.row(pivot).head(count).transpose()) / std::sqrt(left(pivot));
    left = (left - L.col(count).cwiseAbs2()).cwiseMax(0.0);
  }
  return L.leftCols(count);
}

/// 1/2 (v s'(I + v T)^-1 s - log det(I + v T)) of a tridiagonal T: what a field of variance v explains of the scores s, less its price.
double logBayesAt(double v, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside, const Eigen::VectorXd& s) {
  double pivot = 1.0, left = 0.0, explained = 0.0, price = 0.0;
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
    const double off = i == 0 ? 0.0 : v * beside(i - 1);
    const double ratio = off / pivot;
    // No less than the identity: what is below is rounding.
    pivot = std::max(1.0 + v * diagonal(i) - ratio * off, 1.0);
    left = s(i) - ratio * left;
    explained += left * left / pivot;
    price += std::log(pivot);
  }
  return 0.5 * (v * explained - price);
}

/// The mean over the sizes of B, as its log.
double evidenceOf(const Turns& turns, const Eigen::MatrixXd& L) {
  // Q T Q' = L'JL serves all sizes.
  const Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal(L.transpose() * turns.information * L);
  const Eigen::VectorXd diagonal = tridiagonal.diagonal(), beside = tridiagonal.subDiagonal();
  const Eigen::VectorXd s = tridiagonal.matrixQ().adjoint() * (L.transpose() * turns.score);
  std::vector<double> logs;
  for (const double scale : evidenceScales()) {
    logs.push_back(logBayesAt(std::pow(scale * kSearch.typical_wave, 2), diagonal, beside, s));
  }
  return logSumExp(logs) - std::log(static_cast<double>(logs.size()));
}

/// i in base b behind the point: 1, 2, 3 are 1/2, 1/4, 3/4 in base 2. Halton, 1960.
double radicalInverse(std::size_t i, std::size_t base) {
  double value = 0.0, digit = 1.0 / static_cast<double>(base);
  for (; i > 0; i /= base, digit /= static_cast<double>(base)) value += static_cast<double>(i % base) * digit;
  return value;
}

/// Waves that lie evenly in the spectrum of a kernel.
std::vector<AngleWave> wavesOfKernel(const Joints& joints, double length) {
  constexpr std::array<std::size_t, 10> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29};
  const std::size_t count = joints.size() == 2 ? 16 : 24;
  std::vector<AngleWave> waves;
  for (std::size_t i = 1; i <= count; ++i) {
    AngleWave wave;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const double factor = normalQuantile(radicalInverse(i, kPrimes[j % kPrimes.size()])) / length;
      const double rounded = std::round(1000.0 * factor) / 1000.0;
      if (rounded != 0.0) wave[joints[j]] = rounded;
    }
    if (!wave.empty()) waves.push_back(std::move(wave));
  }
  std::sort(waves.begin(), waves.end());
  return waves;
}

struct Field {
  Joints over;
  double length = 0.0, log_weight = 0.0;
};

/// The search for the best field at a joint.
class FieldSearch {
 public:
  FieldSearch(const PortSums& port, const Linearised& linear, const Joints& turning) : turns_(turnsOf(port, linear)), turning_(turning) {
    for (const double length : kLengths) tried_.push_back(weighed(turning, length));
  }

  /// What a field over all joints is worth, the best so far.
  double promise() const { return best().log_weight; }

  const Field& best() const {
    return *std::max_element(tried_.begin(), tried_.end(), [](const Field& a, const Field& b) { return a.log_weight < b.log_weight; });
  }

  /// Over all pairs, and over the threes around the best of them.
  void search() {
    std::vector<Field> pairs;
    for (std::size_t a = 0; a < turning_.size(); ++a) {
      for (std::size_t b = a + 1; b < turning_.size(); ++b) {
        for (const double length : kLengths) pairs.push_back(weighed({turning_[a], turning_[b]}, length));
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Field& a, const Field& b) { return a.log_weight > b.log_weight; });
    std::set<Joints> threes;
    for (std::size_t i = 0; i < std::min(kPairs, pairs.size()); ++i) {
      for (const std::size_t third : turning_) {
        Joints three = pairs[i].over;
        if (std::find(three.begin(), three.end(), third) != three.end()) continue;
        three.insert(std::upper_bound(three.begin(), three.end(), third), third);
        threes.insert(std::move(three));
      }
    }
    tried_.insert(tried_.end(), pairs.begin(), pairs.end());
    for (const Joints& three : threes) {
      for (const double length : kLengths) tried_.push_back(weighed(three, length));
    }
  }

 private:
  static constexpr std::size_t kPairs = 4;  // a field over three joints shows in each pair of them

  Field weighed(const Joints& over, double length) const {
    return {over, length, evidenceOf(turns_, kernelFactor(turns_.q, over, length)) + logShareOf(over, turning_.size())};
  }

  Turns turns_;
  Joints turning_;
  std::vector<Field> tried_;
};

Candidate candidateOf(std::size_t joint, const Field& field, std::size_t among) {
  Candidate candidate;
  candidate.name = kUnknownEffect;
  candidate.place = {PlaceKind::kJoint, joint};
  candidate.curve = Curve{.place = candidate.place, .range = {}, .terms = wavesOfKernel(field.over, field.length), .smooth = true};
  const auto waves = static_cast<Eigen::Index>(candidate.curve->terms.size());
  // Each wave's two factors have the variance that makes all waves together the kernel's.
  candidate.typical = Eigen::VectorXd::Constant(2 * waves, kSearch.typical_wave / std::sqrt(static_cast<double>(waves)));
  candidate.driver = Driver(driversOf(candidate.curve->terms));
  candidate.log_prior = logShareOf(field.over, among);
  return candidate;
}

}  // namespace

std::vector<Candidate> fieldCandidates(const WaveFolds& ports, const Linearised& linear) {
  // Joints beside the one at which it is see some of it too; beyond a few they are not the answer.
  constexpr std::size_t kJoints = 3;
  const Joints turning = turningJoints(linear);
  if (turning.size() < 2) return {};
  std::vector<std::optional<FieldSearch>> searches(ports.joints());
  parallelFor(ports.joints(), linear.jobs, [&](std::size_t joint) { searches[joint].emplace(ports.port(joint), linear, turning); });
  Joints order(ports.joints());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return searches[a]->promise() > searches[b]->promise(); });
  order.resize(std::min(order.size(), kJoints));
  parallelFor(order.size(), linear.jobs, [&](std::size_t i) { searches[order[i]]->search(); });
  std::vector<Candidate> candidates;
  for (const std::size_t joint : order) {
    const Field& best = searches[joint]->best();
    if (!(best.log_weight > 0.0)) continue;
    candidates.push_back(candidateOf(joint, best, turning.size()));
    candidates.back().log_prior += std::log(kSearch.wave_share / static_cast<double>(ports.joints()));
  }
  return candidates;
}

}  // namespace poecal
