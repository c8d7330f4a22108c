// Which explanations hold: forward, with every earlier one judged again beside the later ones, and swapped or dropped where another serves
// better.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/evidence.hpp"

namespace poecal {

/// One answer with all its scanned parameters, and how the rows speak for it.
struct RankedAnswer {
  std::string name, location, driver;
  double log_weight = 0.0;  ///< log of prior share times evidence, summed over scanned parameters; against none
  double log_bayes = 0.0;   ///< evidence of the best instance, with the noise estimated beside it where `exact` is filled
  double chi_square = 0.0;
  std::optional<Candidate> candidate = {};  ///< its best instance, or
  std::optional<std::size_t> scatter = {};  ///< the joint that moves at random
  Evidence screened = {};                   ///< of the best instance
  std::optional<ExactEvidence> exact = {};
};

/// All answers, best first, with what the others are worth.
struct Ranking {
  std::vector<RankedAnswer> answers;
  double log_total = 0.0;          ///< log of the sum of all weights against none
  std::vector<Evidence> screened;  ///< of the candidates, in their order

  /// Sets log_total.
  void sumUp();
  /// Posterior share of an answer among all, none included.
  double probability(std::size_t answer) const;
  /// Bound of the probability that none would look so (Ville): 1 / total evidence.
  double pValue() const;
};

/// One thing that was found.
struct FoundEffect {
  std::optional<Accepted> accepted;    ///< effect or curve, or
  std::optional<std::size_t> scatter;  ///< joint that moves at random
  std::string name, location, driver;
  double log_bayes = 0.0, chi_square = 0.0;
  Ranking ranking;  ///< with all other findings in
};

struct Selection {
  ModelState base;           ///< without effects
  NoiseEstimate base_noise;  ///< there
  Linearised linear;         ///< with all findings, re-fitted
  std::vector<FoundEffect> findings;
  std::vector<Candidate> candidates;
  std::vector<NotTestable> not_testable;
  Ranking base_ranking;                 ///< of all answers, nothing found yet
  std::vector<Evidence> base_evidence;  ///< of the candidates, nothing found yet
  std::vector<std::size_t> bad;         ///< observations that belong to no model, as indices into the measured ones given
  std::vector<std::size_t> kept;        ///< indices of the given observations that remain in `measured`
  MeasuredCell measured;                ///< without the bad ones
};

struct SearchLimits {
  std::size_t most = 4;  ///< findings at which to stop
  bool curves = true;    ///< whether a curve of unknown shape may be an answer
};

/// Searches. @param state  the identified cell. @param wild  observations that a robust fit left out by far; they are left out from the
/// start unless they are a run in time.
Selection selectEffects(const MeasuredCell& measured, const ModelState& state, const std::vector<std::size_t>& wild,
                        const SearchLimits& limits);

/// A state re-fitted with what was accepted, at a noise: Gauss-Newton on the exact residuals.
/// @param groups  poses to fit; empty: all.
Linearised refit(const MeasuredCell& measured, ModelState state, std::vector<Accepted> accepted, const std::vector<std::size_t>& scatter,
                 const NoiseEstimate& noise, const std::vector<std::vector<std::size_t>>& groups, bool new_noise);

}  // namespace poecal
