#include "diagnosis/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnosis/refit.hpp"
#include "diagnosis/screening.hpp"

namespace poecal {
namespace {

constexpr double kScatterShare = 0.2;  // prior share of joints that move at random
constexpr std::size_t kShortlist = 8, kCurveShortlist = 4;

double logSumExp(const std::vector<double>& values) {
  if (values.empty()) return -std::numeric_limits<double>::infinity();
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double value : values) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

/// Score of joint k moving at random by itself, in standard deviations.
double scatterScore(const WhiteResidual& white, const NoiseComponent& joint) {
  double excess = 0.0, variance = 0.0;
  for (std::size_t g = 0; g < white.whitening.poses(); ++g) {
    if (joint.Z[g].cols() == 0) continue;
    const Eigen::VectorXd w = white.whitening.applyTo(g, joint.Z[g]).col(0);
    const double length = w.squaredNorm();
    excess += std::pow(w.dot(white.e.segment(white.whitening.begin(g), white.whitening.size(g))), 2) - length;
    variance += 2.0 * length * length;
  }
  return variance > 0.0 ? excess / std::sqrt(variance) : 0.0;
}

class Ranker {
 public:
  /// @param curves  whether curves of unknown shape may be answers.
  Ranker(const MeasuredCell& measured, const std::vector<Candidate>& candidates, bool curves)
      : measured_(measured), candidates_(candidates), curves_(curves) {}

  Ranking rank(const Linearised& linear, const std::vector<std::string>& taken) const {
    Ranking ranking;
    ranking.screened = screen(linear, candidates_);
    std::map<std::string, std::vector<std::size_t>> by_answer;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (!curves_ && !candidates_[i].known()) continue;
      if (std::find(taken.begin(), taken.end(), candidates_[i].answer()) == taken.end()) by_answer[candidates_[i].answer()].push_back(i);
    }
    for (const auto& [name, members] : by_answer) {
      if (!taken.empty() && !isTestable(ranking, members)) continue;
      std::vector<double> weights;
      std::size_t best = members.front();
      for (const std::size_t i : members) {
        weights.push_back(weight(ranking, i));
        if (weight(ranking, i) > weight(ranking, best)) best = i;
      }
      const Candidate& candidate = candidates_[best];
      ranking.answers.push_back({.name = candidate.name,
                                 .location = candidate.location,
                                 .driver = candidate.driver,
                                 .log_weight = logSumExp(weights),
                                 .log_bayes = ranking.screened[best].log_bayes,
                                 .chi_square = ranking.screened[best].chi_square,
                                 .candidate = candidate,
                                 .scatter = {},
                                 .screened = ranking.screened[best],
                                 .exact = {}});
    }
    findTimes(linear, ranking);
    sort(ranking);
    sharpen(linear, ranking, taken.empty() && leavesPlacesOpen(linear));
    addScatter(linear, taken, ranking);
    sort(ranking);
    ranking.sumUp();
    return ranking;
  }

 private:
  double weight(const Ranking& ranking, std::size_t i) const { return ranking.screened[i].log_bayes + candidates_[i].log_prior; }

  /// Whether an effect of a size that is met on real cells could be seen. What could not is, beside another finding, mostly what that one
  /// does not follow.
  bool isTestable(const Ranking& ranking, const std::vector<std::size_t>& members) const {
    return std::any_of(members.begin(), members.end(),
                       [&](std::size_t i) { return !candidates_[i].known() || smallestSeen(ranking.screened[i].clearest) <= kAbsurdSize; });
  }

  /// Slips that stand out, at the times around their best one that were not tried yet.
  void findTimes(const Linearised& linear, Ranking& ranking) const {
    std::vector<Candidate> untried;
    std::vector<std::pair<std::size_t, std::size_t>> of;  // answer, how many
    for (std::size_t i = 0; i < ranking.answers.size(); ++i) {
      const RankedAnswer& answer = ranking.answers[i];
      if (answer.log_bayes < 0.0) continue;
      const std::vector<Candidate> some = untriedTimes(*answer.candidate, measured_.samples);
      if (some.empty()) continue;
      of.emplace_back(i, some.size());
      untried.insert(untried.end(), some.begin(), some.end());
    }
    if (untried.empty()) return;
    const std::vector<Evidence> evidence = screen(linear, untried);
    std::size_t next = 0;
    for (const auto& [i, count] : of) {
      RankedAnswer& answer = ranking.answers[i];
      const double before = answer.log_bayes;
      std::vector<double> all{before};
      for (const std::size_t end = next + count; next < end; ++next) {
        all.push_back(evidence[next].log_bayes);
        if (evidence[next].log_bayes <= answer.log_bayes) continue;
        answer.log_bayes = evidence[next].log_bayes;
        answer.chi_square = evidence[next].chi_square;
        answer.candidate = untried[next];
        answer.screened = evidence[next];
      }
      // The time that was tried stood for those around it.
      answer.log_weight += logSumExp(all) - std::log(static_cast<double>(all.size())) - before;
    }
  }

  static void sort(Ranking& ranking) {
    std::stable_sort(ranking.answers.begin(), ranking.answers.end(),
                     [](const RankedAnswer& a, const RankedAnswer& b) { return a.log_weight > b.log_weight; });
  }

  /// Whether the capture does not tell within centimetres where the target is on the flange, as no arm does whose axes are parallel.
  bool leavesPlacesOpen(const Linearised& linear) const {
    constexpr double kOpen = 0.02;  // [m]
    const int far = ParameterLayout(linear.state.cell.cell, measured_.free).far;
    return far >= 0 && linear.noise.covariance.diagonal().segment<3>(far + 3).maxCoeff() > kOpen * kOpen;
  }

  /// What the rows say more of an effect where the fit may go from the linearisation to the places at which they show it best.
  double gainOfRefit(const Linearised& linear, const Candidate& candidate, const ExactEvidence& exact) const {
    const Eigen::Index count = candidate.typical.size();
    Accepted one{.candidate = candidate, .factors = Eigen::VectorXd::Zero(count), .scale = exact.scale};
    Linearised plain = linearise(measured_, linear.state, {one}, {}, {});
    setNoise(measured_, linear.noise, plain);
    one.factors = exact.noise.b.tail(count);
    const Linearised fitted = refit(measured_, linear.state, {one}, {}, plain.noise, {}, true);
    return std::max(0.0, fitted.noise.log_likelihood - plain.noise.log_likelihood);
  }

  /// The best few with the noise estimated beside them. @param refitted  where they are weighed after a fit of their own.
  void sharpen(const Linearised& linear, Ranking& ranking, bool refitted) const {
    std::size_t named = 0, curves = 0;
    for (RankedAnswer& answer : ranking.answers) {
      const bool known = answer.candidate->known();
      if ((known ? named : curves) >= (known ? kShortlist : kCurveShortlist)) continue;
      ++(known ? named : curves);
      if (answer.log_bayes < 0.0) continue;
      answer.exact = exactEvidence(linear, measured_, *answer.candidate, answer.screened);
      if (refitted && known) answer.exact->log_bayes += gainOfRefit(linear, *answer.candidate, *answer.exact);
      answer.log_weight += answer.exact->log_bayes - answer.log_bayes;
      answer.log_bayes = answer.exact->log_bayes;
    }
  }

  void addScatter(const Linearised& linear, const std::vector<std::string>& taken, Ranking& ranking) const {
    if (!measured_.start.arm) return;
    const WhiteResidual white = whiteResidual(linear);
    const std::size_t joints = measured_.start.arm->joints.size();
    for (std::size_t k = 0; k < joints; ++k) {
      RankedAnswer answer{.name = "joint_scatter", .location = "joint:" + std::to_string(k + 1), .driver = "none", .scatter = k};
      if (std::find(taken.begin(), taken.end(), answerName(answer.name, answer.location, answer.driver)) != taken.end()) continue;
      constexpr double kWorthTrying = 0.0;
      // Joints are not all alike, and good ones come back to some 1e-5 rad: one is beyond that where it moves twice as far as they do
      // together, and farther than any catalogue allows.
      constexpr double kBeyond = 3.0, kUsual = 4e-5;
      if (scatterScore(white, jointScatter(linear.rows, k, 1.0)) < kWorthTrying) continue;
      answer.exact = scatterEvidence(linear, measured_, k);
      const bool slides = measured_.start.arm->joints[k].type == JointType::kPrismatic;
      if (!(answer.exact->scale > (slides ? kMetresPerRadian : 1.0) * kUsual)) continue;
      const double common = varianceOf("repeatability", linear.components, answer.exact->noise).value_or(0.0);
      if (!(answer.exact->scale * answer.exact->scale > kBeyond * common)) continue;
      answer.log_bayes = answer.exact->log_bayes;
      answer.log_weight = answer.log_bayes + std::log(kScatterShare / static_cast<double>(joints));
      answer.chi_square = 2.0 * std::max(0.0, answer.log_bayes);
      ranking.answers.push_back(std::move(answer));
    }
  }

  const MeasuredCell& measured_;
  const std::vector<Candidate>& candidates_;
  bool curves_;
};

}  // namespace

void Ranking::sumUp() {
  std::vector<double> weights;
  for (const RankedAnswer& answer : answers) weights.push_back(answer.log_weight);
  log_total = logSumExp(weights);
}

double Ranking::probability(std::size_t answer) const {
  // None weighs one.
  const double all = std::max(0.0, log_total) + std::log1p(std::exp(-std::abs(log_total)));
  return std::exp(answers[answer].log_weight - all);
}

double Ranking::pValue() const { return std::min(1.0, std::exp(-log_total)); }

Ranking rank(const MeasuredCell& measured, const std::vector<Candidate>& candidates, bool curves, const Linearised& linear,
             const std::vector<std::string>& taken) {
  return Ranker(measured, candidates, curves).rank(linear, taken);
}

std::size_t chosenAnswer(const Ranking& ranking) {
  const RankedAnswer& best = ranking.answers.front();
  if (!best.candidate || best.candidate->known()) return 0;
  for (std::size_t i = 1; i < ranking.answers.size(); ++i) {
    const RankedAnswer& other = ranking.answers[i];
    const bool named = other.exact && other.candidate && other.candidate->known();
    if (named && other.log_weight > best.log_weight - kRelativeMisfit * best.chi_square) return i;
  }
  return 0;
}

}  // namespace poecal
