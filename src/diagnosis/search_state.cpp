#include "diagnosis/search_state.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/refit.hpp"

namespace poecal {

Ranking SearchState::ranked(const Linearised& at, std::optional<std::size_t> without) {
  std::vector<Candidate> kept;
  if (without && selection.findings[*without].accepted) kept.push_back(selection.findings[*without].accepted->candidate);
  return rank(selection.measured, selection.candidates, limits_.curves ? &waves_ : nullptr, at, taken(without), kept,
              limits_.label + ", round " + std::to_string(++round_));
}

void SearchState::listCandidates() {
  CandidateList list = allCandidates(selection.measured, linear.state);
  std::erase_if(list.candidates,
                [this](const Candidate& candidate) { return candidate.known() && limits_.refused.contains(candidate.answer()); });
  selection.candidates = std::move(list.candidates);
  selection.not_testable = std::move(list.not_testable);
  selection.ordered_by = list.ordered_by;
}

std::vector<Accepted> SearchState::accepted(std::optional<std::size_t> without) const {
  std::vector<Accepted> all;
  for (std::size_t i = 0; i < selection.findings.size(); ++i) {
    if (i != without && selection.findings[i].accepted) all.push_back(*selection.findings[i].accepted);
  }
  return all;
}

std::vector<std::size_t> SearchState::scatter(std::optional<std::size_t> without) const {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < selection.findings.size(); ++i) {
    if (i != without && selection.findings[i].scatter) all.push_back(*selection.findings[i].scatter);
  }
  return all;
}

std::vector<std::string> SearchState::taken(std::optional<std::size_t> without) const {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < selection.findings.size(); ++i) {
    const FoundEffect& found = selection.findings[i];
    if (i != without) all.push_back(answerName(found.name, found.place, found.driver));
  }
  return all;
}

void SearchState::add(const Ranking& ranking, std::size_t chosen) {
  FoundEffect found = findingOf(ranking.answers[chosen]);
  found.ranking = ranking;
  std::swap(found.ranking.answers[0], found.ranking.answers[chosen]);
  selection.findings.push_back(std::move(found));
  refitAll();
}

void SearchState::handBack() {
  std::size_t next = 0;
  for (FoundEffect& found : selection.findings) {
    if (found.accepted) found.accepted = linear.accepted[next++];
  }
}

void SearchState::refitAll() {
  NoiseEstimate from = linear.noise;
  // Joints that move at random begin anew: which they are may have changed.
  from.theta.conservativeResize(std::count_if(linear.components.begin(), linear.components.end(),
                                              [](const NoiseComponent& component) { return !component.name.starts_with("scatter"); }));
  linear = {};  // the bulk of the memory; the next one need not stand beside it
  linear = refit(selection.measured, selection.base, accepted(), scatter(), from, {}, true);
  handBack();
}

FoundEffect findingOf(const RankedAnswer& answer) {
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

bool isWaves(const FoundEffect& found) { return found.accepted && found.accepted->candidate.isWaves(); }

double fittedShare(const Candidate& candidate) { return candidate.log_prior - std::log(static_cast<double>(evidenceScales().size())); }

}  // namespace poecal
