#include "diagnosis/selection.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "diagnosis/refit.hpp"
#include "diagnosis/search_state.hpp"
#include "diagnosis/structure.hpp"
#include "diagnosis/thresholds.hpp"
#include "diagnosis/wild_poses.hpp"

namespace poecal {
namespace {

class Selector {
 public:
  Selector(const MeasuredCell& measured, const ModelState& state, const SearchLimits& limits)
      : given_(measured), waves_(*measured.start.arm, measured.samples), limits_(limits), search_(state, waves_, limits_) {
    useTheRest();
  }

  Selection run(const std::vector<std::size_t>& wild) {
    if (!isRunInTime(selection_.measured, groupsOf(wild))) remove(wild);
    linear_ = refit(selection_.measured, selection_.base, {}, {}, NoiseEstimate{}, {}, true);
    dropBad(kSearch.wild_at_once);
    search_.listCandidates();
    selection_.base = linear_.state;
    selection_.base_noise = linear_.noise;
    for (;;) {
      const Ranking ranking = search_.ranked();
      if (selection_.findings.empty()) {
        selection_.base_evidence = ranking.screened;
        selection_.base_candidates = selection_.candidates;
        selection_.base_ranking = ranking;
      }
      if ((selection_.findings.size() < limits_.most && accept(ranking)) || acceptTwo(ranking)) {
        settle();
        if (isNew()) continue;
      }
      // What stands out now does so beside every explanation.
      if (nameStructure()) {
        settle();
      } else if (!dropBad(kSearch.wild_at_last) && !takeBack()) {
        break;
      }
      settled_.clear();
      search_.listCandidates();
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
  bool accept(const Ranking& ranking) {
    if (ranking.answers.empty()) return false;
    const std::size_t chosen = chosenAnswer(ranking);
    const RankedAnswer& answer = ranking.answers[chosen];
    // Explanations that are hard to tell apart speak together for there being something.
    const bool first = selection_.findings.empty();
    if (!(first ? ranking.log_total > kSearch.anything : answer.log_weight > neededBeside(answer))) return false;
    if (answer.scatter && takeStructureBeside(search_, ranking, answer)) return true;
    const std::size_t others = selection_.findings.size();
    takeUp(search_, ranking, chosen);
    bool grown = false;
    if (limits_.curves) {
      preferCurve(search_, ranking, chosen);
      grown = growStructure(search_);
      splitIntoNames(search_);
      nameWhatHasAName(search_, selection_.findings.size() - 1);
    }
    newest_is_weighed_ = !grown && selection_.findings.size() == others + 1 && isAnswer(answer, selection_.findings.back());
    return true;
  }

  /// Evidence that an answer needs beside the findings.
  double neededBeside(const RankedAnswer& answer) const {
    const double needed = kSearch.beside + kSearch.relative_misfit * explained();
    // Beside a curve of unknown shape another finding is mostly what the curve did not follow.
    const bool unknown_before =
        std::any_of(selection_.findings.begin(), selection_.findings.end(), [](const FoundEffect& found) { return found.isUnknown(); });
    return unknown_before ? needed + kSearch.beside_unknown + kSearch.unknown_misfit * explained() + besideItsCurve(answer) : needed;
  }

  /// Two effects of which each takes the other for the arm's own unrest: neither is enough alone, and each is with the other in.
  bool acceptTwo(const Ranking& ranking) {
    if (selection_.findings.empty() || ranking.answers.empty() || selection_.findings.size() + 2 > limits_.most) return false;
    const std::size_t one = chosenAnswer(ranking);
    const auto isNamed = [](const RankedAnswer& answer) { return answer.candidate && answer.candidate->known(); };
    if (!isNamed(ranking.answers[one]) || !(ranking.answers[one].log_weight > kSearch.needed)) return false;
    const std::vector<FoundEffect> before = selection_.findings;
    search_.add(ranking, one);
    const Ranking beside = search_.ranked();
    const std::size_t other = beside.answers.empty() ? 0 : chosenAnswer(beside);
    if (!beside.answers.empty() && isNamed(beside.answers[other]) &&
        beside.answers[other].log_weight > neededBeside(beside.answers[other])) {
      search_.add(beside, other);
      const FoundEffect& first = selection_.findings[before.size()];
      const Ranking again = search_.ranked(fitWithout(before.size()), before.size());
      if (std::any_of(again.answers.begin(), again.answers.end(),
                      [&](const RankedAnswer& answer) { return isAnswer(answer, first) && answer.log_weight > neededBeside(answer); })) {
        return true;
      }
    }
    selection_.findings = before;
    search_.refitAll();
    return false;
  }

  /// @return whether some structure is a named effect and a rest
  bool nameStructure() {
    if (!limits_.curves || !named_.insert(search_.taken()).second) return false;
    for (std::size_t i = 0; i < selection_.findings.size(); ++i) {
      if (nameWhatHasAName(search_, i)) return true;
    }
    return false;
  }

  /// What the largest finding explains, of which its imprecision may leave a share.
  double explained() const {
    double most = 0.0;
    for (const FoundEffect& found : selection_.findings) most = std::max(most, found.chi_square);
    return most;
  }

  /// What more an answer has to explain at the place of a curve of unknown shape.
  double besideItsCurve(const RankedAnswer& answer) const {
    double more = 0.0;
    for (const FoundEffect& found : selection_.findings) {
      if (found.isUnknown() && found.place == answer.place) more = std::max(more, kSearch.unknown_own_misfit * found.chi_square);
    }
    return more;
  }

  /// Whether an answer is what a finding says.
  static bool isAnswer(const RankedAnswer& answer, const FoundEffect& found) {
    return answer.name == found.name && answer.place == found.place && answer.driver == found.driver;
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

  /// The fit with all findings but one.
  Linearised fitWithout(std::size_t i) const {
    return refit(selection_.measured, selection_.base, search_.accepted(i), search_.scatter(i), linear_.noise, {}, true);
  }

  /// Each finding again beside all others: another answer that serves better takes its place, one that is not needed goes.
  void settle() {
    bool newest_is_weighed = std::exchange(newest_is_weighed_, false);
    if (selection_.findings.size() < 2) return;
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      bool changed = false;
      for (std::size_t i = 0; i < selection_.findings.size(); ++i) {
        if (newest_is_weighed && i + 1 == selection_.findings.size()) continue;
        const Linearised others = fitWithout(i);
        Ranking ranking = search_.ranked(others, i);
        const FoundEffect& now = selection_.findings[i];
        const std::size_t chosen = chosenFor(now, ranking);
        if (chosen == ranking.answers.size() || holdsBesideStructure(i, ranking, chosen)) continue;
        const RankedAnswer& best = ranking.answers[chosen];
        const bool waves = best.candidate && best.candidate->isWaves() && isWaves(now);
        const bool same = isAnswer(best, now) || (waves && best.name == now.name && best.place == now.place);
        if (!(best.log_weight > kSearch.needed)) {
          if (isMissed(now, others)) continue;
          newest_is_weighed = false;
          selection_.findings.erase(selection_.findings.begin() + static_cast<std::ptrdiff_t>(i));
          search_.refitAll();
          changed = true;
          break;
        }
        FoundEffect next = findingOf(best);
        if (same && now.accepted) next.accepted = now.accepted;
        if (same) next.driver = now.driver;
        next.ranking = std::move(ranking);
        std::swap(next.ranking.answers[0], next.ranking.answers[chosen]);
        selection_.findings[i] = std::move(next);
        if (!same) {
          newest_is_weighed = false;
          search_.refitAll();
          changed = true;
        }
      }
      if (!changed) break;
    }
  }

  /// Whether a finding with a name keeps its name and its odds beside structure that was found later. That was chosen beside the name, and
  /// what it did not follow would count for or against others: they were weighed without it.
  bool holdsBesideStructure(std::size_t i, const Ranking& ranking, std::size_t chosen) const {
    const FoundEffect& now = selection_.findings[i];
    if (now.scatter || now.isUnknown()) return false;
    // What a curve was taken apart into was weighed against the curve, which is no rival of it beside the rest.
    const std::vector<RankedAnswer>& before = now.ranking.answers;
    if (std::any_of(before.begin(), before.end(), [&](const auto& other) { return other.log_weight > before.front().log_weight; }))
      return false;
    const auto later = selection_.findings.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    if (std::none_of(later, selection_.findings.end(), [](const FoundEffect& found) { return found.isUnknown(); })) return false;
    const auto same =
        std::find_if(ranking.answers.begin(), ranking.answers.end(), [&now](const RankedAnswer& answer) { return isAnswer(answer, now); });
    if (same == ranking.answers.end() || !(same->log_weight > kSearch.needed)) return false;
    const RankedAnswer& best = ranking.answers[chosen];
    const bool named = best.candidate && best.candidate->known();
    return named && best.log_weight - same->log_weight < kSearch.beside_unknown;
  }

  /// Whether the fit without a finding is worse by more than chance, though its linearisation does not show the finding: the others went
  /// far to stand in for it.
  bool isMissed(const FoundEffect& found, const Linearised& others) const {
    if (!found.accepted) return false;
    return linear_.logLikelihood() - others.logLikelihood() + fittedShare(found.accepted->candidate) > kSearch.needed;
  }

  /// Whether these findings together were not settled on before with the same poses: what is then taken in and given up again goes on for
  /// ever.
  bool isNew() {
    std::vector<std::string> names = search_.taken();
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
      linear_ = refit(selection_.measured, linear_.state, search_.accepted(), search_.scatter(), linear_.noise, {}, true);
      search_.handBack();
    }
    return any;
  }

  /// Poses that were not fitted, at the model with all findings.
  Linearised besideFindings(const MeasuredCell& out) const {
    return linearise(out, linear_.state, linear_.accepted, search_.scatter(), {});
  }

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
    linear_ = refit(selection_.measured, linear_.state, search_.accepted(), search_.scatter(), linear_.noise, {}, true);
    search_.handBack();
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
  bool newest_is_weighed_ = false;              ///< beside all others as they are: it was taken from that ranking
  std::set<std::vector<std::string>> settled_;  ///< names of the findings that were settled on together
  std::set<std::vector<std::string>> named_;    ///< those in which names were looked for
  SearchLimits limits_;
  SearchState search_;
  Selection& selection_ = search_.selection;
  Linearised& linear_ = search_.linear;
};

}  // namespace

Selection selectEffects(const MeasuredCell& measured, const ModelState& state, const std::vector<std::size_t>& wild,
                        const SearchLimits& limits) {
  return Selector(measured, state, limits).run(wild);
}

}  // namespace poecal
