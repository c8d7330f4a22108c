#include "diagnosis/selection.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "diagnosis/screening.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

// Logs of odds. That there is anything: without an effect 1 capture in 200 reaches 0.5 for all explanations together.
constexpr double kAnything = 1.0;
constexpr double kBeside = 4.5;            // of another finding beside the first
constexpr double kNeeded = 2.5;            // of each of several, with all others in
constexpr double kScatterShare = 0.2;      // prior share of joints that move at random
constexpr double kRelativeMisfit = 0.005;  // of an explanation's chi-square that its own imprecision may leave: 7 % of its size
constexpr std::size_t kShortlist = 8, kCurveShortlist = 4;

double logSumExp(const std::vector<double>& values) {
  if (values.empty()) return -std::numeric_limits<double>::infinity();
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double value : values) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

/// Residuals of a linearisation in units of their noise, and what each pose's rows of joint k do there.
struct WhiteResidual {
  Whitening whitening;
  Eigen::VectorXd e;
};

WhiteResidual whiteResidual(const Linearised& linear) {
  WhiteResidual white{Whitening(linear.rows, linear.components, linear.noise.theta), {}};
  white.e = white.whitening.apply(linear.residual());
  return white;
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

/// Ranks all explanations at a linearisation that has its noise.
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
      if (std::find(taken.begin(), taken.end(), answer.name + "@" + answer.location + "/none") != taken.end()) continue;
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

/// The answer to give: the best, but a named one that a curve beats only by what its own imprecision leaves.
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

class Selector {
 public:
  Selector(const MeasuredCell& measured, const ModelState& state, const SearchLimits& limits) : limits_(limits) {
    selection_.measured = measured;
    selection_.base = state;
    selection_.kept.resize(measured.observations.size());
    std::iota(selection_.kept.begin(), selection_.kept.end(), 0);
  }

  Selection run(const std::vector<std::size_t>& wild) {
    const std::vector<std::size_t> at_once = groupsOf(wild);
    if (!isRunInTime(at_once)) remove(at_once);
    linear_ = refit(selection_.measured, selection_.base, {}, {}, NoiseEstimate{}, {}, true);
    dropBad(kWildAtOnce);
    listCandidates();
    selection_.base = linear_.state;
    selection_.base_noise = linear_.noise;
    for (;;) {
      const Ranking ranking = ranker().rank(linear_, taken());
      if (selection_.findings.empty()) {
        selection_.base_evidence = ranking.screened;
        selection_.base_ranking = ranking;
      }
      if (selection_.findings.size() < limits_.most && accept(ranking)) {
        settle();
        continue;
      }
      // What stands out now does so beside every explanation.
      if (!dropBad(kWildAtLast)) break;
      listCandidates();
      if (selection_.findings.empty()) {
        selection_.base = linear_.state;
        selection_.base_noise = linear_.noise;
      }
    }
    selection_.linear = std::move(linear_);
    return std::move(selection_);
  }

 private:
  /// When a pose belongs to no model: its mean square in units of its noise, and how improbable that is.
  struct Wild {
    double mean_square;
    double probability;
  };
  // Before any effect is known only what no effect does to a single pose; at the end what chance does not do once in ten million captures.
  static constexpr Wild kWildAtOnce{150.0, 1e-30}, kWildAtLast{8.0, 1e-9};

  Ranker ranker() const { return Ranker(selection_.measured, selection_.candidates, limits_.curves); }

  void listCandidates() {
    CandidateList list = allCandidates(selection_.measured, linear_.state);
    selection_.candidates = std::move(list.candidates);
    selection_.not_testable = std::move(list.not_testable);
  }

  std::vector<Accepted> accepted(std::optional<std::size_t> without = {}) const {
    std::vector<Accepted> all;
    for (std::size_t i = 0; i < selection_.findings.size(); ++i) {
      if (i != without && selection_.findings[i].accepted) all.push_back(*selection_.findings[i].accepted);
    }
    return all;
  }
  std::vector<std::size_t> scatter(std::optional<std::size_t> without = {}) const {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < selection_.findings.size(); ++i) {
      if (i != without && selection_.findings[i].scatter) all.push_back(*selection_.findings[i].scatter);
    }
    return all;
  }
  std::vector<std::string> taken(std::optional<std::size_t> without = {}) const {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < selection_.findings.size(); ++i) {
      const FoundEffect& found = selection_.findings[i];
      if (i != without) all.push_back(found.name + "@" + found.location + "/" + found.driver);
    }
    return all;
  }

  /// What the largest finding explains, of which its imprecision may leave a share.
  double explained() const {
    double most = 0.0;
    for (const FoundEffect& found : selection_.findings) most = std::max(most, found.chi_square);
    return most;
  }

  static FoundEffect finding(const RankedAnswer& answer) {
    FoundEffect found;
    found.name = answer.name;
    found.location = answer.location;
    found.driver = answer.driver;
    found.log_bayes = answer.log_bayes;
    found.chi_square = answer.chi_square;
    found.scatter = answer.scatter;
    if (answer.candidate) {
      Accepted one;
      one.candidate = *answer.candidate;
      one.scale = answer.exact ? answer.exact->scale : 1.0;
      const Eigen::Index count = one.candidate.typical.size();
      one.factors = answer.exact ? Eigen::VectorXd(answer.exact->noise.b.tail(count)) : Eigen::VectorXd::Zero(count);
      found.accepted = one;
    }
    return found;
  }

  bool accept(const Ranking& ranking) {
    if (ranking.answers.empty()) return false;
    const std::size_t chosen = chosenAnswer(ranking);
    const RankedAnswer& answer = ranking.answers[chosen];
    const bool first = selection_.findings.empty();
    double needed = first ? kAnything : kBeside + kRelativeMisfit * explained();
    // Beside a curve of unknown shape another finding is mostly what the curve did not follow.
    const bool unknown_before = std::any_of(selection_.findings.begin(), selection_.findings.end(),
                                            [](const FoundEffect& found) { return found.name == "unknown"; });
    if (unknown_before) needed += 14.0 + 0.02 * explained();
    // Explanations that are hard to tell apart speak together for there being something.
    if (!((first ? ranking.log_total : answer.log_weight) > needed)) return false;
    take(ranking, chosen);
    if (!limits_.curves) return true;
    const double left = structureLeftAt(answer);
    if (const std::optional<std::size_t> curve = curveThatExplainsMore(ranking, answer, left)) {
      selection_.findings.pop_back();
      // What is left beside the named one speaks against its being all that there is.
      Ranking judged = ranking;
      judged.answers[chosen].log_weight -= left;
      judged.sumUp();
      take(judged, *curve);
    }
    return true;
  }

  void take(const Ranking& ranking, std::size_t chosen) {
    FoundEffect found = finding(ranking.answers[chosen]);
    found.ranking = ranking;
    std::swap(found.ranking.answers[0], found.ranking.answers[chosen]);
    selection_.findings.push_back(std::move(found));
    refitAll();
  }

  /// Log of the odds that a curve at a named effect's place still finds something with the effect in; 0 where there is nothing to say.
  double structureLeftAt(const RankedAnswer& named) const {
    if (named.name == "unknown") return 0.0;
    std::vector<Candidate> there;
    for (const Candidate& candidate : selection_.candidates) {
      if (!candidate.known() && candidate.location == named.location) there.push_back(candidate);
    }
    double left = 0.0;
    for (const Evidence& evidence : screen(linear_, there)) left = std::max(left, evidence.log_bayes);
    return left;
  }

  /// A named effect is not the cause where, with it in, a curve at the same place still finds structure: it is the nearest shape that has a
  /// name. @return the answer to give instead: the best curve there.
  static std::optional<std::size_t> curveThatExplainsMore(const Ranking& ranking, const RankedAnswer& named, double left) {
    constexpr double kStructure = 3.0;
    if (!(left > kStructure + kRelativeMisfit * named.chi_square)) return {};
    for (std::size_t i = 0; i < ranking.answers.size(); ++i) {
      const RankedAnswer& answer = ranking.answers[i];
      // A curve that explains clearly less is not what the named one stands for: then two effects are at one place.
      if (answer.name == "unknown" && answer.location == named.location && answer.log_weight > named.log_weight - left) return i;
    }
    return {};
  }

  /// What the last fit made of the accepted ones, to the findings that they are of.
  void handBack() {
    std::size_t next = 0;
    for (FoundEffect& found : selection_.findings) {
      if (found.accepted) found.accepted = linear_.accepted[next++];
    }
  }

  void refitAll() {
    NoiseEstimate from = linear_.noise;
    // Joints that move at random begin anew: which they are may have changed.
    from.theta.conservativeResize(std::count_if(linear_.components.begin(), linear_.components.end(),
                                                [](const NoiseComponent& component) { return !component.name.starts_with("scatter"); }));
    linear_ = {};  // the bulk of the memory; the next one need not stand beside it
    linear_ = refit(selection_.measured, selection_.base, accepted(), scatter(), from, {}, true);
    handBack();
  }

  /// Each finding again beside all others: another answer that serves better takes its place, one that is not needed goes.
  void settle() {
    if (selection_.findings.size() < 2) return;
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      bool changed = false;
      for (std::size_t i = 0; i < selection_.findings.size(); ++i) {
        Linearised others = refit(selection_.measured, selection_.base, accepted(i), scatter(i), linear_.noise, {}, true);
        Ranking ranking = ranker().rank(others, taken(i));
        const std::size_t chosen = ranking.answers.empty() ? 0 : chosenAnswer(ranking);
        const RankedAnswer& best = ranking.answers[chosen];
        const FoundEffect& now = selection_.findings[i];
        const bool same = best.name == now.name && best.location == now.location && best.driver == now.driver;
        if (!(best.log_weight > kNeeded)) {
          selection_.findings.erase(selection_.findings.begin() + static_cast<std::ptrdiff_t>(i));
          refitAll();
          changed = true;
          break;
        }
        FoundEffect next = finding(best);
        if (same && now.accepted) next.accepted = now.accepted;
        next.ranking = std::move(ranking);
        std::swap(next.ranking.answers[0], next.ranking.answers[chosen]);
        selection_.findings[i] = std::move(next);
        if (!same) {
          refitAll();
          changed = true;
        }
      }
      if (!changed) break;
    }
  }

  /// Poses with a shot among some observations.
  std::vector<std::size_t> groupsOf(const std::vector<std::size_t>& observations) const {
    std::vector<std::size_t> groups;
    for (std::size_t g = 0; g < selection_.measured.groups.size(); ++g) {
      const std::vector<std::size_t>& shots = selection_.measured.groups[g];
      const bool any = std::any_of(shots.begin(), shots.end(),
                                   [&](std::size_t k) { return std::binary_search(observations.begin(), observations.end(), k); });
      if (any) groups.push_back(g);
    }
    return groups;
  }

  /// Takes out poses that belong to no model. @return whether there were any.
  bool dropBad(const Wild& wild) {
    bool any = false;
    // Each round's noise no longer contains what the one before took out.
    constexpr int kRounds = 20;
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<std::size_t> bad = wildPoses(wild);
      if (bad.empty()) break;
      remove(bad);
      any = true;
      linear_ = refit(selection_.measured, linear_.state, accepted(), scatter(), linear_.noise, {}, true);
      handBack();
    }
    return any;
  }

  std::vector<std::size_t> wildPoses(const Wild& wild) const {
    const WhiteResidual white = whiteResidual(linear_);
    std::vector<double> mean_squares;
    std::vector<double> chances;
    for (std::size_t g = 0; g < white.whitening.poses(); ++g) {
      const int size = white.whitening.size(g);
      const double square = white.e.segment(white.whitening.begin(g), size).squaredNorm();
      mean_squares.push_back(square / size);
      chances.push_back(square);
    }
    const double usual = std::max(1e-12, median(mean_squares)) / 0.9;
    std::vector<std::size_t> bad;
    for (std::size_t g = 0; g < mean_squares.size(); ++g) {
      const double relative = mean_squares[g] / usual;
      const double tail = chiSquareTail(chances[g] / usual, white.whitening.size(g));
      if (relative > wild.mean_square && tail < wild.probability) bad.push_back(g);
    }
    // A run of them at the end (or the start) of the session is something that moved, not rows that went wrong.
    if (isRunInTime(bad)) return {};
    // More than a fifth is no sprinkling of wild rows.
    if (bad.size() > mean_squares.size() / 3) return {};
    return bad;
  }

  bool isRunInTime(const std::vector<std::size_t>& bad) const {
    if (bad.size() < 3) return false;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t g = 0; g < selection_.measured.groups.size(); ++g) {
      const Sample& sample = selection_.measured.samples[selection_.measured.groups[g].front()];
      if (!sample.stamp) return false;
      order.emplace_back(*sample.stamp, g);
    }
    std::sort(order.begin(), order.end());
    const auto is_bad = [&](std::size_t k) { return std::find(bad.begin(), bad.end(), order[k].second) != bad.end(); };
    std::size_t late = 0, early = 0;
    while (late < order.size() && is_bad(order.size() - 1 - late)) ++late;
    while (early < order.size() && is_bad(early)) ++early;
    return late >= 3 || early >= 3;
  }

  void remove(const std::vector<std::size_t>& groups) {
    MeasuredCell& measured = selection_.measured;
    std::vector<bool> gone(measured.observations.size(), false);
    for (const std::size_t g : groups) {
      for (const std::size_t k : measured.groups[g]) gone[k] = true;
    }
    MeasuredCell rest = measured;
    rest.observations.clear();
    rest.samples.clear();
    rest.groups.clear();
    std::vector<std::size_t> kept, place(gone.size());
    for (std::size_t k = 0; k < gone.size(); ++k) {
      if (gone[k]) {
        selection_.bad.push_back(selection_.kept[k]);
        continue;
      }
      place[k] = rest.observations.size();
      rest.observations.push_back(measured.observations[k]);
      rest.samples.push_back(measured.samples[k]);
      kept.push_back(selection_.kept[k]);
    }
    for (const std::vector<std::size_t>& group : measured.groups) {
      std::vector<std::size_t> members;
      for (const std::size_t k : group) {
        if (!gone[k]) members.push_back(place[k]);
      }
      if (!members.empty()) rest.groups.push_back(members);
    }
    measured = std::move(rest);
    selection_.kept = std::move(kept);
    std::sort(selection_.bad.begin(), selection_.bad.end());
  }

  Selection selection_;
  Linearised linear_;
  SearchLimits limits_;
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

Selection selectEffects(const MeasuredCell& measured, const ModelState& state, const std::vector<std::size_t>& wild,
                        const SearchLimits& limits) {
  return Selector(measured, state, limits).run(wild);
}

}  // namespace poecal
