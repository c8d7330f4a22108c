#include "diagnosis/harmonics.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "diagnosis/thresholds.hpp"
#include "poecal/core/parallel.hpp"

namespace poecal {
namespace {

constexpr std::size_t kChunkWaves = 64;  // multiplied at a time
constexpr double kHopeless = -1e300;

using Entry = WaveDictionary::Entry;

/// What the rows say of each wave at a joint beside all that the model has already.
struct Scores {
  explicit Scores(std::size_t count) : values(Eigen::MatrixXf::Zero(5, static_cast<Eigen::Index>(count))) {}
  Eigen::MatrixXf values;  ///< u_c, u_s, S_cc, S_ss, S_cs of each
};

/// A joint as the rows see it; see waveCandidates().
struct Port {
  Eigen::VectorXd weight;  ///< |p|^2 of each pose
  Eigen::VectorXd score;   ///< p.e
  Eigen::MatrixXd seen;    ///< V' p, one column a pose
};

/// Evidence of one wave by its factors' information and score.
struct WaveEvidence {
  double log_bayes = kHopeless, scale = 1.0;
};

WaveEvidence evidenceOf(const Eigen::Vector2d& u, const Eigen::Matrix2d& S, double typical, double raw) {
  constexpr double kSeen = 1e-3, kDistinct = 0.02;  // shares below which the rows do not show a wave, or not both of its factors
  const double square = typical * typical;
  const double determinant = S.determinant();
  if (!(S.trace() > kSeen * raw) || !(determinant > kDistinct * S(0, 0) * S(1, 1))) return {};
  WaveEvidence best;
  double sum = 0.0, largest = kHopeless;
  for (const double scale : evidenceScales()) {
    // log det(1 + a S) and u' (S + 1/a)^-1 u of two by two.
    const double a = scale * scale * square;
    const double whole = 1.0 + a * S.trace() + a * a * determinant;
    const Eigen::Matrix2d adjugate{{S(1, 1) + 1.0 / a, -S(0, 1)}, {-S(0, 1), S(0, 0) + 1.0 / a}};
    const double log_bayes = 0.5 * (a * a * u.dot(adjugate * u) / whole - std::log(whole));
    if (log_bayes > largest) {
      sum = sum * std::exp(largest - log_bayes) + 1.0;
      largest = log_bayes;
      best.scale = scale;
    } else {
      sum += std::exp(log_bayes - largest);
    }
  }
  best.log_bayes = largest + std::log(sum / static_cast<double>(evidenceScales().size()));
  return best;
}

/// Waves of a joint and their values at the poses.
class Waves {
 public:
  Waves(const WaveDictionary& dictionary, const Linearised& linear) : dictionary_(dictionary) {
    const CaptureRows& rows = linear.rows;
    const auto poses = static_cast<Eigen::Index>(rows.groups.size());
    const auto joints = rows.observations.front().context.sample.q.size();
    q_.resize(poses, joints);
    // Repeat shots stand at the same readings.
    for (Eigen::Index g = 0; g < poses; ++g) {
      q_.row(g) = rows.observations[rows.groups[static_cast<std::size_t>(g)].front()].context.sample.q;
    }
    cosines_.resize(poses, joints * kHalves);
    sines_.resize(poses, joints * kHalves);
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
      for (Eigen::Index halves = 1; halves <= kHalves; ++halves) {
        const Eigen::ArrayXd phase = 0.5 * static_cast<double>(halves) * q_.col(joint).array();
        cosines_.col(joint * kHalves + halves - 1) = phase.cos().cast<float>();
        sines_.col(joint * kHalves + halves - 1) = phase.sin().cast<float>();
      }
    }
  }

  std::size_t count(std::size_t joint) const { return dictionary_.common().size() + dictionary_.own(joint).size(); }
  const Entry& entry(std::size_t joint, std::size_t i) const {
    const std::size_t common = dictionary_.common().size();
    return i < common ? dictionary_.common()[i] : dictionary_.own(joint)[i - common];
  }
  double typical(std::size_t joint, std::size_t i) const { return dictionary_.unit(joint) * entry(joint, i).typical; }

  /// cos(n.q) and sin(n.q) of the waves [begin, end) of a joint, poses x waves.
  void at(std::size_t joint, std::size_t begin, std::size_t end, Eigen::ArrayXXf& cosines, Eigen::ArrayXXf& sines) const {
    cosines.resize(q_.rows(), static_cast<Eigen::Index>(end - begin));
    sines.resize(q_.rows(), static_cast<Eigen::Index>(end - begin));
    Eigen::ArrayXf before(q_.rows());
    for (std::size_t i = begin; i < end; ++i) {
      auto c = cosines.col(static_cast<Eigen::Index>(i - begin)), s = sines.col(static_cast<Eigen::Index>(i - begin));
      const AngleWave& wave = entry(joint, i).wave;
      if (i >= dictionary_.common().size()) {
        const Eigen::ArrayXf phase = phases(wave).cast<float>();
        c = phase.cos();
        s = phase.sin();
        continue;
      }
      c.setOnes();
      s.setZero();
      // exp(i (a + b)) = exp(i a) exp(i b).
      for (const auto& [of, factor] : wave) {
        const Eigen::Index column = static_cast<Eigen::Index>(of) * kHalves + static_cast<Eigen::Index>(2.0 * std::abs(factor)) - 1;
        const float sign = factor < 0.0 ? -1.0F : 1.0F;
        before = c;
        c = before * cosines_.col(column) - sign * (s * sines_.col(column));
        s = s * cosines_.col(column) + sign * (before * sines_.col(column));
      }
    }
  }

  /// cos and sin of one, to full precision.
  Eigen::MatrixX2d exactly(const AngleWave& wave) const {
    const Eigen::ArrayXd phase = phases(wave);
    Eigen::MatrixX2d both(phase.size(), 2);
    both << phase.cos(), phase.sin();
    return both;
  }

 private:
  static constexpr Eigen::Index kHalves = 8;

  Eigen::ArrayXd phases(const AngleWave& wave) const {
    Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(q_.rows());
    for (const auto& [joint, factor] : wave) sum += factor * q_.col(static_cast<Eigen::Index>(joint)).array();
    return sum;
  }

  const WaveDictionary& dictionary_;
  Eigen::MatrixXd q_;                ///< poses x joints
  Eigen::ArrayXXf cosines_, sines_;  ///< of each joint times 0.5, 1, ... 4
};

/// The search at one linearisation.
class WaveSearch {
 public:
  /// @param folds  outlive this, as all do.
  WaveSearch(const WaveFolds& folds, const Linearised& linear, const WaveDictionary& dictionary)
      : linear_(linear), waves_(dictionary, linear), folds_(folds) {
    const Eigen::MatrixXd root = rootOf(linear.noise.covariance);
    for (std::size_t k = 0; k < folds_.joints(); ++k) {
      const PortSums& sums = folds_.port(k);
      ports_.push_back(
          {sums.weight, sums.residual - sums.cross.transpose() * linear.noise.b, mainDirections(root.transpose() * sums.cross)});
    }
  }

  /// The waves worth their price at a joint, best first; see waveCandidates().
  struct Path {
    std::vector<Entry> waves;  ///< typical in the joint's unit
    double scale = 1.0;
  };
  Path path(std::size_t joint, std::size_t most) const {
    Port port = ports_[joint];
    Scores scores = scored(joint, port);
    Path path;
    std::vector<Eigen::MatrixX2d> shapes;
    std::vector<double> variances;
    while (path.waves.size() < most) {
      const Best best = bestOf(joint, port, scores);
      if (!(best.log_weight > 0.0)) break;
      Entry taken = waves_.entry(joint, best.wave);
      taken.typical = waves_.typical(joint, best.wave);
      if (path.waves.empty()) path.scale = best.scale;
      shapes.push_back(waves_.exactly(taken.wave));
      variances.push_back(std::pow(taken.typical * path.scale, 2));
      path.waves.push_back(taken);
      take(joint, shapes.back(), variances.back(), port, scores);
    }
    path.waves.resize(folds_.bestCount(joint, shapes, variances));
    return path;
  }

  std::size_t joints() const { return ports_.size(); }

  /// Joints at which a wave is worth its price, the best first.
  std::vector<std::size_t> promising() const {
    std::vector<std::pair<double, std::size_t>> all;
    for (std::size_t k = 0; k < joints(); ++k) {
      const double weight = bestOf(k, ports_[k], scored(k, ports_[k])).log_weight;
      if (weight > 0.0) all.emplace_back(-weight, k);
    }
    std::sort(all.begin(), all.end());
    std::vector<std::size_t> order;
    for (const auto& [weight, k] : all) order.push_back(k);
    return order;
  }

 private:
  /// V' p turned to its main directions, without those that nothing of a wave can lie along.
  static Eigen::MatrixXd mainDirections(const Eigen::MatrixXd& seen) {
    constexpr double kNothing = 1e-5;  // share of a wave's norm at most
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(seen * seen.transpose());
    const double least = kNothing * eigen.eigenvalues().sum() / static_cast<double>(seen.cols());
    Eigen::Index small = 0;
    while (small < seen.rows() && eigen.eigenvalues()(small) < least) ++small;
    return eigen.eigenvectors().rightCols(seen.rows() - small).transpose() * seen;
  }

  struct Best {
    std::size_t wave = 0;
    double log_weight = kHopeless, scale = 1.0;
  };

  /// Calls visit(first wave, cosines, sines) for all waves of a joint, some at a time, on linear_.jobs threads.
  template <typename Visit>
  void forChunks(std::size_t joint, Visit visit) const {
    const std::size_t count = waves_.count(joint), chunks = (count + kChunkWaves - 1) / kChunkWaves;
    parallelFor(chunks, linear_.jobs, [&](std::size_t chunk) {
      Eigen::ArrayXXf cosines, sines;
      const std::size_t begin = chunk * kChunkWaves;
      waves_.at(joint, begin, std::min(count, begin + kChunkWaves), cosines, sines);
      visit(static_cast<Eigen::Index>(begin), cosines.matrix(), sines.matrix());
    });
  }

  Scores scored(std::size_t joint, const Port& port) const {
    Scores scores(waves_.count(joint));
    const Eigen::VectorXf weight = port.weight.cast<float>(), score = port.score.cast<float>();
    const Eigen::MatrixXf seen = port.seen.cast<float>();
    forChunks(joint, [&](Eigen::Index begin, const auto& c, const auto& s) {
      const Eigen::MatrixXf seen_c = seen * c, seen_s = seen * s;
      auto values = scores.values.middleCols(begin, c.cols());
      values.row(0) = score.transpose() * c;
      values.row(1) = score.transpose() * s;
      values.row(2) = weight.transpose() * c.cwiseAbs2() - seen_c.colwise().squaredNorm();
      values.row(3) = weight.transpose() * s.cwiseAbs2() - seen_s.colwise().squaredNorm();
      values.row(4) = weight.transpose() * c.cwiseProduct(s) - seen_c.cwiseProduct(seen_s).colwise().sum();
    });
    return scores;
  }

  Best bestOf(std::size_t joint, const Port& port, const Scores& scores) const {
    const double raw = port.weight.sum();
    Best best;
    for (std::size_t i = 0; i < waves_.count(joint); ++i) {
      const Eigen::Matrix<double, 5, 1> v = scores.values.col(static_cast<Eigen::Index>(i)).cast<double>();
      const Eigen::Matrix2d S{{v(2), v(4)}, {v(4), v(3)}};
      const WaveEvidence evidence = evidenceOf(v.head<2>(), S, waves_.typical(joint, i), raw);
      const double log_weight = evidence.log_bayes + waves_.entry(joint, i).log_share;
      if (log_weight > best.log_weight) best = {i, log_weight, evidence.scale};
    }
    return best;
  }

  /// Puts a wave beside what the model has already. @param variance  of its factors, before the rows are looked at.
  void take(std::size_t joint, const Eigen::MatrixX2d& shape, double variance, Port& port, Scores& scores) const {
    const Eigen::MatrixX2d seen = port.seen * shape;
    const Eigen::MatrixX2d weighted = port.weight.asDiagonal() * shape;
    Eigen::Matrix2d information = shape.transpose() * weighted - seen.transpose() * seen;
    information.diagonal().array() += 1.0 / variance;
    const Eigen::LLT<Eigen::Matrix2d> llt(information);
    // Of a wave phi beside this one: S loses |H' phi|^2, u loses (H' phi).y.
    const Eigen::MatrixX2d H = llt.matrixL().solve((weighted - port.seen.transpose() * seen).transpose()).transpose();
    const Eigen::Vector2d y = llt.matrixL().solve(Eigen::Vector2d(shape.transpose() * port.score));
    port.score -= H * y;
    port.seen.conservativeResize(port.seen.rows() + 2, Eigen::NoChange);
    port.seen.bottomRows<2>() = H.transpose();
    const Eigen::Matrix2Xf across = H.transpose().cast<float>();
    const Eigen::Vector2f moved = y.cast<float>();
    forChunks(joint, [&](Eigen::Index begin, const auto& c, const auto& s) {
      const Eigen::Matrix2Xf of_c = across * c, of_s = across * s;
      auto values = scores.values.middleCols(begin, c.cols());
      values.row(0) -= moved.transpose() * of_c;
      values.row(1) -= moved.transpose() * of_s;
      values.row(2) -= of_c.colwise().squaredNorm();
      values.row(3) -= of_s.colwise().squaredNorm();
      values.row(4) -= of_c.cwiseProduct(of_s).colwise().sum();
    });
  }

  const Linearised& linear_;
  Waves waves_;
  const WaveFolds& folds_;
  std::vector<Port> ports_;
};

/// Whether gravity's torque on a joint can have a wave in it: turning the joint turns gravity in its body once, and so does every other
/// joint that has a part in it.
bool isOfGravity(std::size_t joint, const AngleWave& wave) {
  return wave.contains(joint) && std::all_of(wave.begin(), wave.end(), [](const auto& term) { return std::abs(term.second) == 1.0; });
}

/// A single wave of the joint's own angle is joint_eccentricity or joint_harmonic; waves of gravity are a compliance.
bool hasAName(std::size_t joint, const std::vector<Entry>& waves) {
  if (waves.size() == 1 && waves.front().wave.size() == 1 && waves.front().wave.begin()->first == joint) return true;
  return std::all_of(waves.begin(), waves.end(), [joint](const Entry& entry) { return isOfGravity(joint, entry.wave); });
}

/// All waves of a path as one explanation at a joint, beside those of `before`. @param log_share  of the joint.
Candidate candidateOf(std::size_t joint, const std::vector<Entry>& waves, double log_share, const Candidate* before) {
  std::map<AngleWave, double> typical;
  Candidate candidate;
  candidate.name = kUnknownEffect;
  candidate.place = {PlaceKind::kJoint, joint};
  candidate.curve = Curve{.place = candidate.place, .range = {}, .waves = 0, .orders = 0, .terms = {}};
  candidate.log_prior = log_share;
  if (before != nullptr) {
    candidate.log_prior = before->log_prior;
    for (std::size_t i = 0; i < before->curve->terms.size(); ++i) {
      typical[before->curve->terms[i]] = before->typical(2 * static_cast<Eigen::Index>(i));
    }
  }
  for (const Entry& entry : waves) {
    typical[entry.wave] = entry.typical;
    candidate.log_prior += entry.log_share;
  }
  candidate.typical.resize(2 * static_cast<Eigen::Index>(typical.size()));
  Eigen::Index next = 0;
  for (const auto& [wave, sigma] : typical) {
    candidate.curve->terms.push_back(wave);
    candidate.typical.segment<2>(next).setConstant(sigma);
    next += 2;
  }
  candidate.driver = Driver(driversOf(candidate.curve->terms));
  return candidate;
}

/// All n of at most three of some joints whose |n_j| are among these, the first of them positive: the other half are the same waves.
std::vector<AngleWave> wavesOf(const std::vector<std::size_t>& joints, const std::vector<double>& factors) {
  constexpr std::size_t kTogether = 3;
  std::vector<AngleWave> all;
  std::vector<AngleWave> shorter{{}};
  for (std::size_t together = 1; together <= kTogether; ++together) {
    std::vector<AngleWave> longer;
    for (const AngleWave& wave : shorter) {
      for (const std::size_t joint : joints) {
        if (!wave.empty() && joint <= wave.rbegin()->first) continue;
        for (const double factor : factors) {
          for (const double sign : {1.0, -1.0}) {
            if (wave.empty() && sign < 0.0) continue;
            longer.push_back(wave);
            longer.back()[joint] = sign * factor;
          }
        }
      }
    }
    all.insert(all.end(), longer.begin(), longer.end());
    shorter = std::move(longer);
  }
  return all;
}

/// Waves of whole factors are those of gears, discs and gravity. A joint seldom goes round: what is smooth over its range, and no more, is
/// of halves.
std::vector<AngleWave> commonWaves(const std::vector<std::size_t>& joints) {
  std::vector<AngleWave> all = wavesOf(joints, {1.0, 2.0, 3.0, 4.0});
  for (AngleWave& wave : wavesOf(joints, {0.5, 1.0, 1.5})) {
    const bool halves = std::any_of(wave.begin(), wave.end(), [](const auto& term) { return std::remainder(term.second, 1.0) != 0.0; });
    if (halves) all.push_back(std::move(wave));
  }
  return all;
}

double sizeOf(const AngleWave& wave) {
  return std::accumulate(wave.begin(), wave.end(), 0.0, [](double sum, const auto& term) { return sum + std::abs(term.second); });
}

}  // namespace

WaveDictionary::WaveDictionary(const Arm& arm, const std::vector<Sample>& samples) {
  constexpr double kFine = 4.0;                      // |n| at which waves are half as large
  constexpr double kLowest = 4.5, kHighest = 200.0;  // of those: lower ones are among the whole waves nearly
  constexpr double kSpacing = 1.6;                   // [rad] of phase over the joint's range from one order to the next
  std::vector<double> range(arm.joints.size(), 0.0);
  std::vector<std::size_t> turning;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end(), [k](const Sample& a, const Sample& b) {
      return a.q(static_cast<Eigen::Index>(k)) < b.q(static_cast<Eigen::Index>(k));
    });
    range[k] = high->q(static_cast<Eigen::Index>(k)) - low->q(static_cast<Eigen::Index>(k));
    unit_.push_back(1.0);
    if (arm.joints[k].type == JointType::kRevolute && range[k] > kSearch.still) turning.push_back(k);
  }
  double total = 0.0;
  for (AngleWave& wave : commonWaves(turning)) {
    const double size = sizeOf(wave);
    // A wave of a size is one of about size^2: all sizes together are alike.
    common_.push_back({std::move(wave), std::pow(std::max(1.0, size), -2), kSearch.typical_wave / (1.0 + size / kFine)});
    total += common_.back().log_share;
  }
  for (Entry& entry : common_) entry.log_share = std::log(kSearch.whole_factors * entry.log_share / total);
  own_.resize(arm.joints.size());
  for (const std::size_t k : turning) {
    const double step = kSpacing / std::min(range[k], 2.0 * M_PI);
    for (int i = 0; kLowest + i * step <= kHighest; ++i) {
      const double order = std::round(1000.0 * (kLowest + i * step)) / 1000.0;
      own_[k].push_back({{{k, order}}, 0.0, kSearch.typical_wave / (1.0 + 1.0 / kFine)});
    }
    for (Entry& entry : own_[k]) entry.log_share = std::log((1.0 - kSearch.whole_factors) / static_cast<double>(own_[k].size()));
  }
}

std::vector<Candidate> waveCandidates(const WaveFolds& ports, const Linearised& linear, const WaveDictionary& dictionary,
                                      std::size_t most) {
  if (dictionary.common().empty()) return {};
  const WaveSearch search(ports, linear, dictionary);
  std::vector<Candidate> candidates;
  // Joints beside the one at which it is see some of it too; beyond a few they are not the answer.
  constexpr std::size_t kJoints = 3;
  std::vector<std::size_t> joints = search.promising();
  joints.resize(std::min(joints.size(), kJoints));
  for (const std::size_t k : joints) {
    const auto path = search.path(k, most);
    if (path.waves.empty()) continue;
    // What has a name is told by it, unless more of the same kind is left beside it.
    const double share = hasAName(k, path.waves) ? kSearch.named_wave * kSearch.wave_share : kSearch.wave_share;
    candidates.push_back(candidateOf(k, path.waves, std::log(share / static_cast<double>(search.joints())), nullptr));
  }
  return candidates;
}

std::optional<Candidate> wavesAt(const MeasuredCell& measured, const Linearised& linear, const WaveDictionary& dictionary,
                                 std::size_t joint, std::size_t most) {
  const WaveFolds ports(measured, linear);
  const auto path = WaveSearch(ports, linear, dictionary).path(joint, most);
  if (path.waves.empty()) return {};
  return candidateOf(joint, path.waves, 0.0, nullptr);
}

std::optional<Candidate> moreWaves(const MeasuredCell& measured, const Linearised& linear, const WaveDictionary& dictionary,
                                   const Candidate& waves) {
  const std::size_t most = mostWaves(linear.rows.groups.size()), have = waves.curve->terms.size();
  // A smooth field is all of its waves already.
  if (have >= most || waves.curve->smooth) return {};
  const WaveFolds ports(measured, linear);
  const auto path = WaveSearch(ports, linear, dictionary).path(waves.curve->place.index, most - have);
  if (path.waves.empty()) return {};
  return candidateOf(waves.curve->place.index, path.waves, 0.0, &waves);
}

}  // namespace poecal
