// What a search for effects knows while it goes on: its findings, and the fit with all of them in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/selection.hpp"

namespace poecal {

class SearchState {
 public:
  /// @param state  the identified cell. @param waves, limits  outlive this.
  SearchState(const ModelState& state, const WaveDictionary& waves, const SearchLimits& limits) : waves_(waves), limits_(limits) {
    selection.base = state;
  }

  Selection selection;  ///< but for its `linear`
  Linearised linear;    ///< with all findings, re-fitted

  const WaveDictionary& waves() const { return waves_; }
  const SearchLimits& limits() const { return limits_; }

  /// All answers at a linearisation. @param without  the finding that is not in it.
  Ranking ranked(const Linearised& at, std::optional<std::size_t> without = {});
  Ranking ranked() { return ranked(linear); }
  /// Names the candidates there are at the fit.
  void listCandidates();

  /// What is in the fit: effects and curves, and joints that move at random. @param without  a finding to leave out.
  std::vector<Accepted> accepted(std::optional<std::size_t> without = {}) const;
  std::vector<std::size_t> scatter(std::optional<std::size_t> without = {}) const;

  /// Takes up an answer as a further finding, and fits again.
  void add(const Ranking& ranking, std::size_t chosen);
  /// Fits again from the identified cell.
  void refitAll();
  /// What the last fit made of the accepted ones, to the findings that they are of.
  void handBack();

  /// Names of the answers that the findings are.
  std::vector<std::string> taken(std::optional<std::size_t> without = {}) const;

 private:
  const WaveDictionary& waves_;
  const SearchLimits& limits_;
  int round_ = 0;  ///< rankings so far
};

/// A finding of an answer, at the factors that its evidence was weighed with.
FoundEffect findingOf(const RankedAnswer& answer);
bool isWaves(const FoundEffect& found);
/// Log of the prior share of an explanation that is in at its best scale, not at all of them.
double fittedShare(const Candidate& candidate);

}  // namespace poecal
