#include "diagnosis/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "diagnosis/refit.hpp"
#include "diagnosis/screening.hpp"
#include "diagnosis/smooth_field.hpp"
#include "diagnosis/thresholds.hpp"

namespace poecal {
namespace {

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
  /// @param waves  nullptr: curves of unknown shape may not be answers.
  Ranker(const MeasuredCell& measured, const std::vector<Candidate>& candidates, const WaveDictionary* waves)
      : measured_(measured), candidates_(candidates), waves_(waves) {}

  Ranking rank(const Linearised& linear, const std::vector<std::string>& taken, const std::vector<Candidate>& kept,
               const std::string& label) const {
    // Screening, times, waves, the best again with their noise, scatter, the best fitted again.
    Progress progress(measured_.progress, label, 6);
    progress.show();
    Ranking ranking;
    ranking.screened = screen(linear, candidates_);
    std::map<std::string, std::vector<std::size_t>> by_answer;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (waves_ == nullptr && !candidates_[i].known()) continue;
      if (!isTaken(candidates_[i], taken)) by_answer[candidates_[i].answer()].push_back(i);
    }
    for (const auto& [name, members] : by_answer) {
      if (!taken.empty() && !isTestable(ranking, members) && !isAmong(kept, name)) continue;
      std::vector<double> weights;
      std::size_t best = members.front();
      for (const std::size_t i : members) {
        weights.push_back(weight(ranking, i));
        if (weight(ranking, i) > weight(ranking, best)) best = i;
      }
      ranking.answers.push_back(answerOf(candidates_[best], ranking.screened[best], logSumExp(weights)));
    }
    progress.advance();
    findTimes(linear, ranking);
    progress.advance();
    addWaves(linear, taken, kept, ranking);
    sort(ranking);
    progress.advance();
    sharpen(linear, ranking);
    progress.advance();
    addScatter(linear, taken, ranking);
    sort(ranking);
    progress.advance();
    weighAgain(linear, ranking, taken.empty() && leavesPlacesOpen(linear));
    sort(ranking);
    progress.advance();
    ranking.sumUp();
    return ranking;
  }

 private:
  static RankedAnswer answerOf(const Candidate& candidate, const Evidence& screened, double log_weight) {
    return {.name = candidate.name,
            .place = candidate.place,
            .driver = candidate.driver,
            .log_weight = log_weight,
            .log_bayes = screened.log_bayes,
            .chi_square = screened.chi_square,
            .candidate = candidate,
            .scatter = {},
            .screened = screened,
            .exact = {}};
  }

  /// Whether an answer is in already: what joint angles drive at a joint is one answer, whatever its shape.
  static bool isTaken(const Candidate& candidate, const std::vector<std::string>& taken) {
    const bool posture = !candidate.known() && candidate.place.kind == PlaceKind::kJoint && candidate.driver.isPosture();
    const std::string there = answerName(candidate.name, candidate.place, Driver("q"));
    return std::any_of(taken.begin(), taken.end(),
                       [&](const std::string& name) { return name == candidate.answer() || (posture && name.starts_with(there)); });
  }

  static bool isAmong(const std::vector<Candidate>& kept, const std::string& answer) {
    return std::any_of(kept.begin(), kept.end(), [&](const Candidate& candidate) { return candidate.answer() == answer; });
  }

  /// Waves of several joints and smooth fields over them: at each joint what serves best.
  void addWaves(const Linearised& linear, const std::vector<std::string>& taken, const std::vector<Candidate>& kept,
                Ranking& ranking) const {
    if (waves_ == nullptr) return;
    constexpr std::size_t kMost = 6;  // of one that is not taken yet: what they explain is clear by then
    const WaveFolds ports(measured_, linear);
    std::vector<Candidate> waves = waveCandidates(ports, linear, *waves_, std::min(kMost, mostWaves(linear.rows.groups.size())));
    const std::vector<Candidate> fields = fieldCandidates(ports, linear);
    waves.insert(waves.end(), fields.begin(), fields.end());
    std::copy_if(kept.begin(), kept.end(), std::back_inserter(waves), [](const Candidate& candidate) { return candidate.isWaves(); });
    const std::vector<Evidence> evidence = screen(linear, waves);
    std::map<Place, RankedAnswer> best;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      if (isTaken(waves[i], taken)) continue;
      RankedAnswer answer = answerOf(waves[i], evidence[i], evidence[i].log_bayes + waves[i].log_prior);
      const auto there = best.find(answer.place);
      if (there == best.end() || there->second.log_weight < answer.log_weight) best[answer.place] = std::move(answer);
    }
    for (auto& [place, answer] : best) {
      const auto same = std::find_if(ranking.answers.begin(), ranking.answers.end(), [&answer = answer](const RankedAnswer& other) {
        return other.name == answer.name && other.place == answer.place && other.driver == answer.driver;
      });
      if (same == ranking.answers.end()) {
        ranking.answers.push_back(std::move(answer));
      } else if (same->log_weight < answer.log_weight) {
        *same = std::move(answer);
      }
    }
  }

  double weight(const Ranking& ranking, std::size_t i) const { return ranking.screened[i].log_bayes + candidates_[i].log_prior; }

  /// Whether an effect of a size that is met on real cells could be seen. What could not is, beside another finding, mostly what that one
  /// does not follow.
  bool isTestable(const Ranking& ranking, const std::vector<std::size_t>& members) const {
    return std::any_of(members.begin(), members.end(), [&](std::size_t i) {
      return !candidates_[i].known() || smallestSeen(ranking.screened[i].clearest) <= kSearch.absurd_size;
    });
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

  /// What the rows say more of an explanation, or less, where the fit goes from the linearisation to the place at which they show it best;
  /// nothing where it comes to no rest.
  std::optional<double> gainOfRefit(const Linearised& linear, const RankedAnswer& answer) const {
    const Eigen::Index count = answer.candidate->typical.size();
    std::vector<Accepted> all = linear.accepted;
    all.push_back({.candidate = *answer.candidate, .factors = Eigen::VectorXd::Zero(count), .scale = answer.exact->scale});
    const std::vector<std::size_t> scatter = scatterOf(linear.components);
    Linearised plain = linearise(measured_, linear.state, all, scatter, {});
    const ExactEvidence& exact = *answer.exact;
    all.back().factors = exact.noise.b.tail(count);
    // What is believed of its factors is the same here and where the fit ends, or belief would be taken for evidence.
    plain.believe(linear.plain_prior.joinedWith(ColumnPrior::independent(fittedSpread(all.back()), Eigen::VectorXd::Zero(count))));
    setNoise(measured_, linear.noise, plain);
    const Linearised fitted = refit(measured_, linear.state, all, scatter, plain.noise, {}, true);
    if (!fitted.settled) return {};
    return fitted.logLikelihood() - plain.logLikelihood();
  }

  /// The best few with the noise estimated beside them.
  void sharpen(const Linearised& linear, Ranking& ranking) const {
    std::size_t named = 0, curves = 0;
    for (RankedAnswer& answer : ranking.answers) {
      const bool known = answer.candidate->known();
      if ((known ? named : curves) >= (known ? kSearch.named_shortlist : kSearch.curve_shortlist)) continue;
      ++(known ? named : curves);
      if (answer.log_bayes < 0.0) continue;
      answer.exact = exactEvidence(linear, measured_, *answer.candidate, answer.screened);
      const double disbelief = answer.candidate->isPositive() ? logSharePositive(*answer.exact, *answer.candidate) : 0.0;
      noteAgainstGravity(answer, disbelief, ranking);
      answer.exact->log_bayes += disbelief;
      answer.log_weight += answer.exact->log_bayes - answer.log_bayes;
      answer.log_bayes = answer.exact->log_bayes;
    }
  }

  static void noteAgainstGravity(const RankedAnswer& answer, double disbelief, Ranking& ranking) {
    constexpr double kBeyondDoubt = -10.0;
    const double weight = answer.log_weight + answer.exact->log_bayes - answer.log_bayes;
    if (disbelief > kBeyondDoubt || (ranking.against_gravity && ranking.against_gravity->log_weight >= weight)) return;
    ranking.against_gravity = AgainstGravity{answer.name, answer.place, weight, disbelief};
  }

  /// Log of what belief in sizes above zero alone does to the evidence. A link's two compliances are the sum and the difference of its two
  /// parameters.
  static double logSharePositive(const ExactEvidence& exact, const Candidate& candidate) {
    const Eigen::Index count = candidate.typical.size();
    if (candidate.own() < 2) return logShareAboveZero(exact, count, Eigen::VectorXd::Ones(1));
    return std::min(logShareAboveZero(exact, count, Eigen::Vector2d(1.0, 1.0)),
                    logShareAboveZero(exact, count, Eigen::Vector2d(1.0, -1.0)));
  }

  /// The same of one size: twice the share of the posterior that lies there. @param direction  of the candidate's first factors.
  static double logShareAboveZero(const ExactEvidence& exact, Eigen::Index columns, const Eigen::VectorXd& direction) {
    const Eigen::Index i = exact.noise.b.size() - columns, n = direction.size();
    const double variance = direction.dot(exact.noise.covariance.block(i, i, n, n) * direction);
    const double sigma = std::sqrt(std::max(variance, 1e-300)), z = direction.dot(exact.noise.b.segment(i, n)) / sigma;
    // Beyond that erfc is nothing: its asymptote.
    if (z < -30.0) return -0.5 * z * z - std::log(-z) + 0.5 * std::log(2.0 / M_PI);
    return std::log(std::erfc(-z / std::sqrt(2.0)));
  }

  /// Explanations that one linearisation cannot tell apart, each fitted again with the arm from the same start: evidence there decides. One
  /// whose fit comes to no rest is no answer. @param always  also where there is only one.
  void weighAgain(const Linearised& linear, Ranking& ranking, bool always) const {
    if (ranking.answers.empty()) return;
    const RankedAnswer& best = ranking.answers.front();
    if (!(best.log_weight > 0.0)) return;
    const double least = best.log_weight - std::max(kSearch.reach, kSearch.far_reach * best.chi_square);
    std::size_t count = 0;
    while (count < std::min(kSearch.fitted_again, ranking.answers.size()) && ranking.answers[count].log_weight > least) ++count;
    if (count < 2 && !always) return;
    // What stands first once those before it came to no rest has to come to rest itself.
    for (std::size_t fitted = 0; fitted < count || !ranking.answers.front().fitted_again; ++fitted) {
      const auto next =
          std::find_if(ranking.answers.begin(), ranking.answers.end(), [](const auto& answer) { return !answer.fitted_again; });
      if (next == ranking.answers.end()) break;
      if (!fitAgain(linear, *next)) ranking.answers.erase(next);
      if (ranking.answers.empty()) break;
      if (fitted + 1 >= count) sort(ranking);
    }
  }

  /// Takes an answer's evidence, where it has some, from a fit without linearisation. @return whether that comes to rest
  bool fitAgain(const Linearised& linear, RankedAnswer& answer) const {
    answer.fitted_again = true;
    if (!answer.exact || !answer.candidate) return true;
    const std::optional<double> gain = gainOfRefit(linear, answer);
    if (!gain) return false;
    answer.exact->log_bayes += *gain;
    answer.log_bayes += *gain;
    answer.log_weight += *gain;
    return true;
  }

  void addScatter(const Linearised& linear, const std::vector<std::string>& taken, Ranking& ranking) const {
    if (!measured_.start.arm) return;
    const WhiteResidual white = whiteResidual(linear);
    const std::size_t joints = measured_.start.arm->joints.size();
    for (std::size_t k = 0; k < joints; ++k) {
      RankedAnswer answer{.name = "joint_scatter", .place = {PlaceKind::kJoint, k}, .driver = Driver("none"), .scatter = k};
      if (std::find(taken.begin(), taken.end(), answerName(answer.name, answer.place, answer.driver)) != taken.end()) continue;
      // What a curve at the joint does not follow is its remainder.
      const std::string curve = answerName(kUnknownEffect, answer.place, Driver("q"));
      if (std::any_of(taken.begin(), taken.end(), [&curve](const std::string& name) { return name.starts_with(curve); })) continue;
      // Joints are not all alike, and good ones come back to some 1e-5 rad: one is beyond that where it moves twice as far as they do
      // together, and farther than any catalogue allows.
      constexpr double kBeyond = 3.0, kUsual = 4e-5;
      if (scatterScore(white, jointScatter(linear.rows, k, 1.0)) < kSearch.scatter_worth_trying) continue;
      answer.exact = scatterEvidence(linear, measured_, k);
      const bool slides = measured_.start.arm->joints[k].type == JointType::kPrismatic;
      if (!(answer.exact->scale > (slides ? kMetresPerRadian : 1.0) * kUsual)) continue;
      const double common = varianceOf("repeatability", linear.components, answer.exact->noise).value_or(0.0);
      if (!(answer.exact->scale * answer.exact->scale > kBeyond * common)) continue;
      answer.log_bayes = answer.exact->log_bayes;
      answer.log_weight = answer.log_bayes + std::log(kSearch.scatter_share / static_cast<double>(joints));
      answer.chi_square = 2.0 * std::max(0.0, answer.log_bayes);
      ranking.answers.push_back(std::move(answer));
    }
  }

  const MeasuredCell& measured_;
  const std::vector<Candidate>& candidates_;
  const WaveDictionary* waves_;
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

Ranking rank(const MeasuredCell& measured, const std::vector<Candidate>& candidates, const WaveDictionary* waves, const Linearised& linear,
             const std::vector<std::string>& taken, const std::vector<Candidate>& kept, const std::string& label) {
  return Ranker(measured, candidates, waves).rank(linear, taken, kept, label);
}

std::size_t chosenAnswer(const Ranking& ranking) {
  const RankedAnswer& best = ranking.answers.front();
  if (!best.candidate || best.candidate->known()) return 0;
  for (std::size_t i = 1; i < ranking.answers.size(); ++i) {
    const RankedAnswer& other = ranking.answers[i];
    const bool named = other.exact && other.candidate && other.candidate->known();
    if (named && other.log_weight > best.log_weight - kSearch.relative_misfit * best.chi_square) return i;
  }
  return 0;
}

}  // namespace poecal
