// All explanations beside each other: how the rows speak for each, and which of them to name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/evidence.hpp"
#include "diagnosis/harmonics.hpp"

namespace poecal {

/// One answer with all its scanned parameters, and how the rows speak for it.
struct RankedAnswer {
  std::string name;
  Place place;
  Driver driver;
  double log_weight = 0.0;  ///< log of prior share times evidence, summed over scanned parameters; against none
  double log_bayes = 0.0;   ///< evidence of the best instance, with the noise estimated beside it where `exact` is filled
  double chi_square = 0.0;
  std::optional<Candidate> candidate = {};  ///< its best instance, or
  std::optional<std::size_t> scatter = {};  ///< the joint that moves at random
  Evidence screened = {};                   ///< of the best instance
  std::optional<ExactEvidence> exact = {};
  bool fitted_again = false;  ///< without linearisation
};

/// What yields to gravity where its size comes out below zero: nothing does, unless gravity points the other way than it was said to.
struct AgainstGravity {
  std::string name;
  Place place;
  double log_weight = 0.0;  ///< were that sign allowed
  double disbelief = 0.0;   ///< how much of it the sign takes away; below zero
};

/// All answers, best first, with what the others are worth.
struct Ranking {
  std::vector<RankedAnswer> answers;
  double log_total = 0.0;                              ///< log of the sum of all weights against none
  std::vector<Evidence> screened;                      ///< of the candidates, in their order
  std::optional<AgainstGravity> against_gravity = {};  ///< the best of its kind

  /// Sets log_total.
  void sumUp();
  /// Posterior share of an answer among all, none included.
  double probability(std::size_t answer) const;
  /// Bound of the probability that none would look so (Ville): 1 / total evidence.
  double pValue() const;
};

/// Ranks all explanations at a linearisation that has its noise.
/// @param waves  of several joints, which stand beside the curves of `candidates`; nullptr: nothing of unknown shape may be an answer.
/// @param taken  answers that are in the linearisation already. @param kept  what was found before and is weighed once more, though it were
/// waves that are not found again or a size of no real cell.
/// @param label  under which `measured.progress` is told of it.
Ranking rank(const MeasuredCell& measured, const std::vector<Candidate>& candidates, const WaveDictionary* waves, const Linearised& linear,
             const std::vector<std::string>& taken, const std::vector<Candidate>& kept, const std::string& label);

/// The answer to give: the best, but a named one that a curve beats only by what its own imprecision leaves.
std::size_t chosenAnswer(const Ranking& ranking);

}  // namespace poecal
