#include "diagnosis/selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "diagnosis/refit.hpp"
#include "diagnosis/screening.hpp"
#include "diagnosis/thresholds.hpp"
#include "diagnosis/wild_poses.hpp"

namespace poecal {
namespace {

class Selector {
 public:
  Selector(const MeasuredCell& measured, const ModelState& state, const SearchLimits& limits)
      : given_(measured), waves_(*measured.start.arm, measured.samples), limits_(limits) {
    selection_.base = state;
    useTheRest();
  }

  Selection run(const std::vector<std::size_t>& wild) {
    if (!isRunInTime(selection_.measured, groupsOf(wild))) remove(wild);
    linear_ = refit(selection_.measured, selection_.base, {}, {}, NoiseEstimate{}, {}, true);
    dropBad(kSearch.wild_at_once);
    listCandidates();
    selection_.base = linear_.state;
    selection_.base_noise = linear_.noise;
    for (;;) {
      const Ranking ranking = ranked(linear_);
      if (selection_.findings.empty()) {
        selection_.base_evidence = ranking.screened;
        selection_.base_candidates = selection_.candidates;
        selection_.base_ranking = ranking;
      }
      if (selection_.findings.size() < limits_.most && accept(ranking)) {
        settle();
        if (isNew()) continue;
      }
      // What stands out now does so beside every explanation.
      if (!dropBad(kSearch.wild_at_last) && !takeBack()) break;
      settled_.clear();
      listCandidates();
      if (selection_.findings.empty()) {
        selection_.base = linear_.state;
        selection_.base_noise = linear_.noise;
      }
    }
    tellBad();
    selection_.linear = std::move(linear_);
    return std::move(selection_);
  }

 private:
  Ranking ranked(const Linearised& linear, std::optional<std::size_t> without = {}) {
    std::vector<Candidate> kept;
    if (without && isWaves(selection_.findings[*without])) kept.push_back(selection_.findings[*without].accepted->candidate);
    return rank(selection_.measured, selection_.candidates, limits_.curves ? &waves_ : nullptr, linear, taken(without), kept,
                limits_.label + ", round " + std::to_string(++round_));
  }

  static bool isWaves(const FoundEffect& found) { return found.accepted && found.accepted->candidate.isWaves(); }

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
      if (i != without) all.push_back(answerName(found.name, found.place, found.driver));
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
    found.place = answer.place;
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
    double needed = first ? kSearch.anything : kSearch.beside + kSearch.relative_misfit * explained();
    // Beside a curve of unknown shape another finding is mostly what the curve did not follow.
    const bool unknown_before =
        std::any_of(selection_.findings.begin(), selection_.findings.end(), [](const FoundEffect& found) { return found.isUnknown(); });
    if (unknown_before) needed += kSearch.beside_unknown + kSearch.unknown_misfit * explained();
    // Explanations that are hard to tell apart speak together for there being something.
    if (!((first ? ranking.log_total : answer.log_weight) > needed)) return false;
    if (answer.scatter && takeStructureBeside(ranking, answer)) return true;
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
    growWaves();
    return true;
  }

  /// Structure that was found beside a harmonic of the same angle is one cause with it: what stands for both takes the place of both.
  void joinHarmonic() {
    const FoundEffect& last = selection_.findings.back();
    if (!last.isUnknown() || last.place.kind != PlaceKind::kJoint) return;
    const auto same_angle = [&last](const FoundEffect& found) {
      return found.accepted && found.accepted->candidate.known() && found.place == last.place && found.driver == last.driver &&
             found.accepted->candidate.effect->kind().parameterOf(ParameterRole::kOrder);
    };
    const auto harmonic = std::find_if(selection_.findings.begin(), selection_.findings.end(), same_angle);
    if (harmonic == selection_.findings.end()) return;
    const Place place = last.place;
    const Driver driver = last.driver;
    const std::vector<FoundEffect> before = selection_.findings;
    selection_.findings.erase(harmonic);
    selection_.findings.pop_back();
    refitAll();
    const Ranking ranking = ranked(linear_);
    for (std::size_t i = 0; i < ranking.answers.size(); ++i) {
      const RankedAnswer& answer = ranking.answers[i];
      if (!answer.candidate || answer.candidate->known() || answer.place != place || answer.driver != driver) continue;
      take(ranking, i);
      return;
    }
    selection_.findings = before;
    refitAll();
  }

  /// Further waves at the joints at which there are some: with those in, the noise is less and more of them show.
  void growWaves() {
    constexpr int kRounds = 4;
    for (FoundEffect& found : selection_.findings) {
      for (int round = 0; round < kRounds && isWaves(found); ++round) {
        std::optional<Candidate> more = moreWaves(selection_.measured, linear_, waves_, found.accepted->candidate);
        if (!more) break;
        found.driver = more->driver;
        found.accepted->factors = factorsIn(*more, *found.accepted);
        found.accepted->candidate = std::move(*more);
        refitAll();
      }
    }
  }

  /// Factors of waves among which there are some that were fitted already; zero of the others.
  static Eigen::VectorXd factorsIn(const Candidate& waves, const Accepted& fitted) {
    Eigen::VectorXd factors = Eigen::VectorXd::Zero(waves.typical.size());
    Eigen::Index next = 0;
    for (const AngleWave& wave : fitted.candidate.curve->terms) {
      const auto at = std::find(waves.curve->terms.begin(), waves.curve->terms.end(), wave) - waves.curve->terms.begin();
      factors.segment<2>(2 * at) = fitted.factors.segment<2>(next);
      next += 2;
    }
    return factors;
  }

  /// A joint that moves at random is what is left when all that follows its pose is known: what can still be told beside it comes first.
  /// @param without  the ranking in which it is the best. @return whether there was any, which is taken in its place.
  bool takeStructureBeside(const Ranking& without, const RankedAnswer& scatter) {
    selection_.findings.push_back(finding(scatter));
    refitAll();
    Ranking beside = ranked(linear_);
    selection_.findings.pop_back();
    const std::size_t chosen = beside.answers.empty() ? 0 : chosenAnswer(beside);
    const bool any = !beside.answers.empty() && beside.answers[chosen].candidate && beside.answers[chosen].log_weight > kSearch.beside;
    if (!any) {
      refitAll();
      return takeWavesInstead(without, scatter);
    }
    if (const std::optional<std::size_t> more = curveThatStandsForBoth(without, beside.answers[chosen], scatter)) {
      take(without, *more);
    } else {
      take(beside, chosen);
    }
    growWaves();
    return true;
  }

  /// Structure of which each wave alone is less than a joint's random motion explains, and all of them are more: they show only one after
  /// the other, the later ones in the quiet that the earlier ones leave. @return whether there was any, which is taken in the scatter's
  /// place.
  bool takeWavesInstead(const Ranking& without, const RankedAnswer& scatter) {
    const auto waves = std::find_if(without.answers.begin(), without.answers.end(), [&scatter](const RankedAnswer& answer) {
      return answer.candidate && answer.candidate->isWaves() && answer.place == scatter.place && answer.log_weight > kSearch.beside;
    });
    if (waves == without.answers.end()) return false;
    const double before = linear_.logLikelihood();
    const auto chosen = static_cast<std::size_t>(waves - without.answers.begin());
    take(without, chosen);
    growWaves();
    FoundEffect& found = selection_.findings.back();
    // The waves are in at their best scale, not at all of them.
    const double weight =
        linear_.logLikelihood() - before + found.accepted->candidate.log_prior - std::log(static_cast<double>(evidenceScales().size()));
    if (!(weight > scatter.log_weight)) {
      selection_.findings.pop_back();
      refitAll();
      return false;
    }
    found.ranking.answers.front().log_weight = weight;
    found.ranking.sumUp();
    return true;
  }

  /// What is driven by its joint's own angle and has more waves than the effect with a name, a saw, leaves its higher waves behind, which
  /// then look random. @return of the answers beside which nothing moves at random, the curve at the joint that serves better than the
  /// named one there does.
  static std::optional<std::size_t> curveThatStandsForBoth(const Ranking& without, const RankedAnswer& named, const RankedAnswer& scatter) {
    if (!named.candidate || !named.candidate->known() || named.place != scatter.place) return {};
    std::optional<std::size_t> curve;
    double of_named = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < without.answers.size(); ++i) {
      const RankedAnswer& answer = without.answers[i];
      if (!answer.candidate || answer.place != named.place || answer.driver != named.driver) continue;
      if (answer.name == named.name) of_named = std::max(of_named, answer.log_weight);
      if (!answer.candidate->known() && !curve) curve = i;
    }
    if (!curve || !(without.answers[*curve].log_weight > of_named + kSearch.structure)) return {};
    return curve;
  }

  void take(const Ranking& ranking, std::size_t chosen) {
    FoundEffect found = finding(ranking.answers[chosen]);
    found.ranking = ranking;
    std::swap(found.ranking.answers[0], found.ranking.answers[chosen]);
    selection_.findings.push_back(std::move(found));
    refitAll();
    joinHarmonic();
  }

  /// Log of the odds that a curve at a named effect's place still finds something with the effect in; 0 where there is nothing to say.
  double structureLeftAt(const RankedAnswer& named) const {
    if (named.candidate && !named.candidate->known()) return 0.0;
    std::vector<Candidate> there;
    for (const Candidate& candidate : selection_.candidates) {
      if (!candidate.known() && candidate.place == named.place) there.push_back(candidate);
    }
    double left = 0.0;
    for (const Evidence& evidence : screen(linear_, there)) left = std::max(left, evidence.log_bayes);
    return left;
  }

  /// A named effect is not the cause where, with it in, a curve at the same place still finds structure: it is the nearest shape that has a
  /// name. @return the answer to give instead: the best curve there.
  static std::optional<std::size_t> curveThatExplainsMore(const Ranking& ranking, const RankedAnswer& named, double left) {
    if (!(left > kSearch.structure + kSearch.relative_misfit * named.chi_square)) return {};
    for (std::size_t i = 0; i < ranking.answers.size(); ++i) {
      const RankedAnswer& answer = ranking.answers[i];
      // A curve that explains clearly less is not what the named one stands for: then two effects are at one place.
      if (answer.candidate && !answer.candidate->known() && answer.place == named.place && answer.log_weight > named.log_weight - left)
        return i;
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

  /// The answer that serves best in a finding's place. Structure does not give way to a joint that moves at random, which explains all.
  static std::size_t chosenFor(const FoundEffect& now, const Ranking& ranking) {
    if (ranking.answers.empty()) return 0;
    const std::size_t chosen = chosenAnswer(ranking);
    if (now.scatter || !ranking.answers[chosen].scatter) return chosen;
    for (std::size_t i = 0; i < ranking.answers.size(); ++i) {
      const RankedAnswer& answer = ranking.answers[i];
      if (answer.candidate && answer.log_weight > kSearch.needed) return answer.name == now.name && answer.place == now.place ? i : chosen;
    }
    return chosen;
  }

  /// Each finding again beside all others: another answer that serves better takes its place, one that is not needed goes.
  void settle() {
    if (selection_.findings.size() < 2) return;
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      bool changed = false;
      for (std::size_t i = 0; i < selection_.findings.size(); ++i) {
        Linearised others = refit(selection_.measured, selection_.base, accepted(i), scatter(i), linear_.noise, {}, true);
        Ranking ranking = ranked(others, i);
        const FoundEffect& now = selection_.findings[i];
        const std::size_t chosen = chosenFor(now, ranking);
        if (chosen == ranking.answers.size()) continue;
        const RankedAnswer& best = ranking.answers[chosen];
        const bool waves = best.candidate && best.candidate->isWaves() && isWaves(now);
        const bool same = best.name == now.name && best.place == now.place && (best.driver == now.driver || waves);
        if (!(best.log_weight > kSearch.needed)) {
          if (isMissed(now, others)) continue;
          selection_.findings.erase(selection_.findings.begin() + static_cast<std::ptrdiff_t>(i));
          refitAll();
          changed = true;
          break;
        }
        FoundEffect next = finding(best);
        if (same && now.accepted) next.accepted = now.accepted;
        if (same) next.driver = now.driver;
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

  /// Whether the fit without a finding is worse by more than chance, though its linearisation does not show the finding: the others went
  /// far to stand in for it.
  bool isMissed(const FoundEffect& found, const Linearised& others) const {
    if (!found.accepted) return false;
    // The finding is in at its best scale, not at all of them.
    const double share = found.accepted->candidate.log_prior - std::log(static_cast<double>(evidenceScales().size()));
    return linear_.logLikelihood() - others.logLikelihood() + share > kSearch.needed;
  }

  /// Whether these findings together were not settled on before with the same poses: what is then taken in and given up again goes on for
  /// ever.
  bool isNew() {
    std::vector<std::string> names = taken();
    std::sort(names.begin(), names.end());
    return settled_.insert(names).second;
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

  /// Takes out rows that belong to no model. @return whether there were any.
  bool dropBad(const Wild& wild) {
    bool any = false;
    // Each round's noise no longer contains what the one before took out.
    constexpr int kRounds = 20;
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<std::size_t> bad = wildRows(selection_.measured, linear_, wild);
      if (bad.empty()) break;
      remove(bad);
      any = true;
      linear_ = refit(selection_.measured, linear_.state, accepted(), scatter(), linear_.noise, {}, true);
      handBack();
    }
    return any;
  }

  /// Poses that were not fitted, at the model with all findings.
  Linearised besideFindings(const MeasuredCell& out) const { return linearise(out, linear_.state, linear_.accepted, scatter(), {}); }

  /// Poses that were taken out before it was known what moves them, and that the model with all findings explains as well as it does
  /// others.
  /// @return whether any came back
  bool takeBack() {
    if (taken_back_ || selection_.findings.empty() || selection_.bad.empty()) return false;
    taken_back_ = true;
    const MeasuredCell out = part(given_, selection_.bad);
    std::vector<std::size_t> back;
    for (const std::size_t g : explainedPoses(linear_, besideFindings(out))) {
      for (const std::size_t k : out.groups[g]) back.push_back(selection_.bad[k]);
    }
    if (back.empty()) return false;
    std::sort(back.begin(), back.end());
    std::erase_if(selection_.bad, [&back](std::size_t k) { return std::binary_search(back.begin(), back.end(), k); });
    useTheRest();
    linear_ = refit(selection_.measured, linear_.state, accepted(), scatter(), linear_.noise, {}, true);
    handBack();
    return true;
  }

  /// How far off the bad ones are beside all findings.
  void tellBad() {
    if (!selection_.bad.empty()) selection_.bad_rms = rmsOfEach(besideFindings(part(given_, selection_.bad)).rows);
  }

  /// Takes rows out. @param observations  of selection_.measured
  void remove(const std::vector<std::size_t>& observations) {
    for (const std::size_t k : observations) selection_.bad.push_back(kept_[k]);
    std::sort(selection_.bad.begin(), selection_.bad.end());
    useTheRest();
  }

  /// What was given, less what is bad, is what is measured.
  void useTheRest() {
    kept_.clear();
    for (std::size_t k = 0; k < given_.observations.size(); ++k) {
      if (!std::binary_search(selection_.bad.begin(), selection_.bad.end(), k)) kept_.push_back(k);
    }
    selection_.measured = part(given_, kept_);
  }

  const MeasuredCell& given_;
  WaveDictionary waves_;
  std::vector<std::size_t> kept_;  ///< numbers in given_ of the observations in selection_.measured
  bool taken_back_ = false;
  std::set<std::vector<std::string>> settled_;  ///< names of the findings that were settled on together
  Selection selection_;
  Linearised linear_;
  SearchLimits limits_;
  int round_ = 0;  ///< rankings so far
};

}  // namespace

Selection selectEffects(const MeasuredCell& measured, const ModelState& state, const std::vector<std::size_t>& wild,
                        const SearchLimits& limits) {
  return Selector(measured, state, limits).run(wild);
}

}  // namespace poecal
