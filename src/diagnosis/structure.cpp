#include "diagnosis/structure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/screening.hpp"
#include "diagnosis/thresholds.hpp"

namespace poecal {
namespace {

/// Structure that was found beside a harmonic of the same angle is one cause with it: what stands for both takes the place of both.
void joinHarmonic(SearchState& search) {
  const FoundEffect& last = search.selection.findings.back();
  if (!last.isUnknown() || last.place.kind != PlaceKind::kJoint) return;
  const auto same_angle = [&last](const FoundEffect& found) {
    return found.accepted && found.accepted->candidate.known() && found.place == last.place && found.driver == last.driver &&
           found.accepted->candidate.effect->kind().parameterOf(ParameterRole::kOrder);
  };
  const auto harmonic = std::find_if(search.selection.findings.begin(), search.selection.findings.end(), same_angle);
  if (harmonic == search.selection.findings.end()) return;
  const Place place = last.place;
  const Driver driver = last.driver;
  const std::vector<FoundEffect> before = search.selection.findings;
  search.selection.findings.erase(harmonic);
  search.selection.findings.pop_back();
  search.refitAll();
  const Ranking ranking = search.ranked();
  for (std::size_t i = 0; i < ranking.answers.size(); ++i) {
    const RankedAnswer& answer = ranking.answers[i];
    if (!answer.candidate || answer.candidate->known() || answer.place != place || answer.driver != driver) continue;
    search.add(ranking, i);
    return;
  }
  search.selection.findings = before;
  search.refitAll();
}

/// Factors of waves among which there are some that were fitted already; zero of the others.
Eigen::VectorXd factorsIn(const Candidate& waves, const Accepted& fitted) {
  Eigen::VectorXd factors = Eigen::VectorXd::Zero(waves.typical.size());
  Eigen::Index next = 0;
  for (const AngleWave& wave : fitted.candidate.curve->terms) {
    const auto at = std::find(waves.curve->terms.begin(), waves.curve->terms.end(), wave) - waves.curve->terms.begin();
    factors.segment<2>(2 * at) = fitted.factors.segment<2>(next);
    next += 2;
  }
  return factors;
}

/// What is driven by its joint's own angle and has more waves than the effect with a name, a saw, leaves its higher waves behind, which
/// then look random. @return of the answers beside which nothing moves at random, the curve at the joint that serves better than the
/// named one there does.
std::optional<std::size_t> curveThatStandsForBoth(const Ranking& without, const RankedAnswer& named, const RankedAnswer& scatter) {
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

/// Log of the odds that a curve at a named effect's place still finds something with the effect in; 0 where there is nothing to say.
double structureLeftAt(const SearchState& search, const RankedAnswer& named) {
  if (named.candidate && !named.candidate->known()) return 0.0;
  std::vector<Candidate> there;
  for (const Candidate& candidate : search.selection.candidates) {
    if (!candidate.known() && candidate.place == named.place) there.push_back(candidate);
  }
  double left = 0.0;
  for (const Evidence& evidence : screen(search.linear, there)) left = std::max(left, evidence.log_bayes);
  return left;
}

/// A named effect is not the cause where, with it in, a curve at the same place still finds structure: it is the nearest shape that has a
/// name. @return the answer to give instead: the best curve there.
std::optional<std::size_t> curveThatExplainsMore(const Ranking& ranking, const RankedAnswer& named, double left) {
  if (!(left > kSearch.structure + kSearch.relative_misfit * named.chi_square)) return {};
  for (std::size_t i = 0; i < ranking.answers.size(); ++i) {
    const RankedAnswer& answer = ranking.answers[i];
    // A curve that explains clearly less is not what the named one stands for: then two effects are at one place.
    if (answer.candidate && !answer.candidate->known() && answer.place == named.place && answer.log_weight > named.log_weight - left)
      return i;
  }
  return {};
}

/// @return whether there were more waves at its joint
bool growWaves(SearchState& search, FoundEffect& found) {
  std::optional<Candidate> more = moreWaves(search.selection.measured, search.linear, search.waves(), found.accepted->candidate);
  if (!more) return false;
  found.driver = more->driver;
  found.accepted->factors = factorsIn(*more, *found.accepted);
  found.accepted->candidate = std::move(*more);
  search.refitAll();
  return true;
}

bool isSway(const FoundEffect& found) {
  return found.accepted && found.accepted->candidate.curve && !found.accepted->candidate.curve->cycles.empty();
}

/// A sway with one more frequency, whose factors are zero.
Accepted withFrequency(const Accepted& sway, double f) {
  constexpr Eigen::Index kAxes = 6;
  Accepted both = sway;
  std::vector<double>& cycles = both.candidate.curve->cycles;
  const auto at = cycles.insert(std::upper_bound(cycles.begin(), cycles.end(), f), f);
  const Eigen::Index before = 2 * (at - cycles.begin()), old = sway.factors.size() / kAxes, all = old + 2;
  both.candidate.typical.setConstant(kAxes * all, sway.candidate.typical(0));
  both.factors.setZero(kAxes * all);
  for (Eigen::Index axis = 0; axis < kAxes; ++axis) {
    both.factors.segment(axis * all, before) = sway.factors.segment(axis * old, before);
    both.factors.segment(axis * all + before + 2, old - before) = sway.factors.segment(axis * old + before, old - before);
  }
  return both;
}

/// @return whether another frequency was worth its price: that of a sway between two that are tried, or of one that is no pure wave
bool growSway(SearchState& search, FoundEffect& found) {
  const Candidate& sway = found.accepted->candidate;
  const std::vector<double>& have = sway.curve->cycles;
  std::vector<Candidate> more;
  for (const Candidate& candidate : search.selection.candidates) {
    const bool same = candidate.curve && candidate.curve->cycles.size() == 1 && candidate.place == sway.place &&
                      candidate.moves_reference == sway.moves_reference;
    if (same && std::find(have.begin(), have.end(), candidate.curve->cycles.front()) == have.end()) more.push_back(candidate);
  }
  if (more.empty()) return false;
  const std::vector<Evidence> evidence = screen(search.linear, more);
  const auto best =
      std::max_element(evidence.begin(), evidence.end(), [](const Evidence& a, const Evidence& b) { return a.log_bayes < b.log_bayes; });
  const double price = std::log(static_cast<double>(more.size()));
  if (!(best->log_bayes > price + kSearch.needed)) return false;
  found.accepted = withFrequency(*found.accepted, more[static_cast<std::size_t>(best - evidence.begin())].curve->cycles.front());
  found.accepted->candidate.log_prior -= price;
  search.refitAll();
  return true;
}

/// Structure of which each wave alone is less than a joint's random motion explains, and all of them are more: they show only one after the
/// other, the later ones in the quiet that the earlier ones leave. @return whether there was any, which is taken in the scatter's place.
bool takeWavesInstead(SearchState& search, const Ranking& without, const RankedAnswer& scatter) {
  const auto waves = std::find_if(without.answers.begin(), without.answers.end(), [&scatter](const RankedAnswer& answer) {
    return answer.candidate && answer.candidate->isWaves() && answer.place == scatter.place && answer.log_weight > kSearch.beside;
  });
  if (waves == without.answers.end()) return false;
  const std::vector<FoundEffect> before = search.selection.findings;
  const double likelihood_before = search.linear.logLikelihood();
  takeUp(search, without, static_cast<std::size_t>(waves - without.answers.begin()));
  growStructure(search);
  FoundEffect& found = search.selection.findings.back();
  const double weight = search.linear.logLikelihood() - likelihood_before + fittedShare(found.accepted->candidate);
  if (!(weight > scatter.log_weight)) {
    search.selection.findings = before;
    search.refitAll();
    return false;
  }
  found.ranking.answers.front().log_weight = weight;
  found.ranking.sumUp();
  return true;
}

/// How many effects with names a curve may be that stands for all of them; 0 where it is one cause.
std::size_t namesThatMayHide(const FoundEffect& found) {
  constexpr std::size_t kMost = 3;
  if (!found.isUnknown() || !found.accepted || !found.accepted->candidate.curve) return 0;
  // A lens that is wrong in one way is often wrong in several, and what grows with time at several places is seen at any of them.
  if (found.place.kind == PlaceKind::kCameraLens) return kMost;
  if (!isWaves(found)) return found.driver.kind() == DriverKind::kStamp ? kMost : 0;
  const std::vector<AngleWave>& terms = found.accepted->candidate.curve->terms;
  const bool single = std::all_of(terms.begin(), terms.end(), [](const AngleWave& wave) { return wave.size() == 1; });
  return single && terms.size() >= 2 && terms.size() <= kMost ? terms.size() : 0;
}

bool isMount(const Place& place) { return place.kind == PlaceKind::kCameraMount || place.kind == PlaceKind::kTargetMount; }

/// Whether what happens at a place could be a part of what some structure does: at the same place; or of what a joint drives at a mount,
/// which moves whichever way the joint does.
bool isSeenAt(const FoundEffect& structure, const Place& place, const Driver& driver) {
  return place == structure.place || (isMount(structure.place) && driver.isPosture() && driver == structure.driver);
}

/// Whether an effect with a name explains enough of what some structure does to be a part of it.
bool isPartOf(const RankedAnswer& answer, const FoundEffect& structure) {
  return answer.candidate && answer.candidate->known() && isSeenAt(structure, answer.place, answer.driver) &&
         answer.log_weight > kSearch.needed;
}

/// Whether effects with names may be a part of it. A curve of time takes whatever grows with time to pieces.
bool mayHoldNames(const FoundEffect& found) {
  if (!found.isUnknown() || !found.accepted || found.driver.kind() == DriverKind::kStamp) return false;
  const std::vector<RankedAnswer>& answers = found.ranking.answers;
  const double least = kSearch.named_part * answers.front().log_weight;
  return std::any_of(answers.begin(), answers.end(),
                     [&](const RankedAnswer& answer) { return isPartOf(answer, found) && answer.log_weight > least; });
}

/// Whether a driver is another, or readings of which the other is one: "q1,q3" includes "q3".
bool includes(const Driver& driver, const Driver& other) {
  const std::vector<std::size_t>& joints = driver.joints();
  return driver == other ||
         (other.kind() == DriverKind::kReading && std::find(joints.begin(), joints.end(), other.joint()) != joints.end());
}

/// Whether structure beside an effect is its own shape, which then has no name: what the effect's own driver drives alone, or whatever of
/// several joints may hold that, as a field over them does. A lens has many numbers, and several of them are often wrong.
bool isOwnShape(const Candidate& structure, const FoundEffect& named) {
  if (structure.place != named.place || named.place.kind == PlaceKind::kCameraLens) return false;
  if (!includes(structure.driver, named.driver)) return false;
  if (!structure.isWaves() || structure.curve->smooth) return true;
  const std::vector<AngleWave>& terms = structure.curve->terms;
  return std::any_of(terms.begin(), terms.end(), [&named](const AngleWave& wave) { return Driver(driversOf({wave})) == named.driver; });
}

/// Evidence that has to speak for an effect as a part of some structure. A field over several joints may hold whatever one of them drives,
/// and its few waves follow a smooth function only roughly.
double neededWithin(const FoundEffect& structure, const FoundEffect& named) {
  const Candidate& whole = structure.accepted->candidate;
  const bool holds = whole.curve->smooth && isOwnShape(whole, named);
  return holds ? kSearch.beside_unknown + kSearch.unknown_own_misfit * structure.chi_square : kSearch.structure;
}

/// Whether an answer is what some structure leaves beside an effect that is a part of it.
bool isRestBeside(const FoundEffect& named, const FoundEffect& structure, const RankedAnswer& answer) {
  return answer.candidate && !answer.candidate->known() && answer.place == structure.place && answer.log_weight > kSearch.needed &&
         !isOwnShape(*answer.candidate, named);
}

}  // namespace

void takeUp(SearchState& search, const Ranking& ranking, std::size_t chosen) {
  search.add(ranking, chosen);
  joinHarmonic(search);
}

bool takeStructureBeside(SearchState& search, const Ranking& without, const RankedAnswer& scatter) {
  search.selection.findings.push_back(findingOf(scatter));
  search.refitAll();
  Ranking beside = search.ranked();
  search.selection.findings.pop_back();
  const std::size_t chosen = beside.answers.empty() ? 0 : chosenAnswer(beside);
  const bool any = !beside.answers.empty() && beside.answers[chosen].candidate && beside.answers[chosen].log_weight > kSearch.beside;
  if (!any) {
    search.refitAll();
    return takeWavesInstead(search, without, scatter);
  }
  if (const std::optional<std::size_t> more = curveThatStandsForBoth(without, beside.answers[chosen], scatter)) {
    takeUp(search, without, *more);
  } else {
    takeUp(search, beside, chosen);
  }
  growStructure(search);
  return true;
}

void preferCurve(SearchState& search, const Ranking& ranking, std::size_t named) {
  const double left = structureLeftAt(search, ranking.answers[named]);
  const std::optional<std::size_t> curve = curveThatExplainsMore(ranking, ranking.answers[named], left);
  if (!curve) return;
  search.selection.findings.pop_back();
  // What is left beside the named one speaks against its being all that there is.
  Ranking judged = ranking;
  judged.answers[named].log_weight -= left;
  judged.sumUp();
  takeUp(search, judged, *curve);
}

bool growStructure(SearchState& search) {
  constexpr int kRounds = 4;
  bool any = false;
  for (FoundEffect& found : search.selection.findings) {
    for (int round = 0; round < kRounds && isWaves(found); ++round) {
      if (!growWaves(search, found)) break;
      any = true;
    }
    for (int round = 0; round < kRounds && isSway(found); ++round) {
      if (!growSway(search, found)) break;
      any = true;
    }
  }
  return any;
}

void splitIntoNames(SearchState& search) {
  std::vector<FoundEffect>& findings = search.selection.findings;
  const std::size_t most = std::min(namesThatMayHide(findings.back()), search.limits().most - findings.size() + 1);
  if (most == 0) return;
  const double of_curve = search.linear.logLikelihood() + fittedShare(findings.back().accepted->candidate);
  const double enough = of_curve - kSearch.relative_misfit * findings.back().chi_square;
  const std::vector<FoundEffect> before = findings;
  const bool lens = findings.back().place.kind == PlaceKind::kCameraLens;
  findings.pop_back();
  search.refitAll();
  double shares = 0.0;
  for (std::size_t i = 0; i < most; ++i) {
    const Ranking ranking = search.ranked();
    const auto named = std::find_if(ranking.answers.begin(), ranking.answers.end(), [](const RankedAnswer& answer) {
      return answer.candidate && answer.candidate->known() && answer.log_weight > 0.0;
    });
    if (named == ranking.answers.end()) break;
    shares += fittedShare(*named->candidate);
    search.add(ranking, static_cast<std::size_t>(named - ranking.answers.begin()));
    // A single name was weighed against the curve already, and names that are all at one place are a curve of time taken to pieces.
    const bool apart = lens || isWaves(before.back()) || findings.back().place != findings[before.size() - 1].place;
    if (i > 0 && apart && search.linear.logLikelihood() + shares > enough) return;
  }
  findings = before;
  search.refitAll();
}

bool nameWhatHasAName(SearchState& search, std::size_t number) {
  std::vector<FoundEffect>& findings = search.selection.findings;
  const FoundEffect whole = findings[number];
  if (!mayHoldNames(whole)) return false;
  const std::vector<FoundEffect> before = findings;
  double best_weight = search.linear.logLikelihood() + fittedShare(whole.accepted->candidate), shares = 0.0;
  findings.erase(findings.begin() + static_cast<std::ptrdiff_t>(number));
  search.refitAll();
  std::vector<FoundEffect> best = before;
  Ranking ranking = search.ranked();
  while (findings.size() + 2 <= search.limits().most) {
    const auto named = std::find_if(ranking.answers.begin(), ranking.answers.end(),
                                    [&whole](const RankedAnswer& answer) { return isPartOf(answer, whole); });
    if (named == ranking.answers.end()) break;
    shares += fittedShare(*named->candidate);
    search.add(ranking, static_cast<std::size_t>(named - ranking.answers.begin()));
    ranking = search.ranked();
    const auto rest = std::find_if(ranking.answers.begin(), ranking.answers.end(),
                                   [&](const RankedAnswer& answer) { return isRestBeside(findings.back(), whole, answer); });
    if (rest == ranking.answers.end()) break;
    const std::vector<FoundEffect> names = findings;
    search.add(ranking, static_cast<std::size_t>(rest - ranking.answers.begin()));
    growStructure(search);
    const double weight = search.linear.logLikelihood() + shares + fittedShare(findings.back().accepted->candidate);
    if (!isOwnShape(findings.back().accepted->candidate, names.back()) && weight > best_weight + neededWithin(whole, names.back())) {
      best_weight = weight;
      best = findings;
    }
    findings = names;
    search.refitAll();
  }
  findings = best;
  search.refitAll();
  return best.size() > before.size();
}

}  // namespace poecal
