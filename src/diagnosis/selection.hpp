// Which explanations hold: forward, with every earlier one judged again beside the later ones, and swapped or dropped where another serves
// better.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "diagnosis/ranking.hpp"

namespace poecal {

/// One thing that was found.
struct FoundEffect {
  std::optional<Accepted> accepted;    ///< effect or curve, or
  std::optional<std::size_t> scatter;  ///< joint that moves at random
  std::string name;
  Place place;
  Driver driver;
  double log_bayes = 0.0, chi_square = 0.0;
  Ranking ranking;  ///< with all other findings in

  bool isUnknown() const { return accepted && !accepted->candidate.known(); }
};

struct Selection {
  ModelState base;           ///< without effects
  NoiseEstimate base_noise;  ///< there
  Linearised linear;         ///< with all findings, re-fitted
  std::vector<FoundEffect> findings;
  std::vector<Candidate> candidates;
  std::vector<NotTestable> not_testable;
  std::optional<std::size_t> ordered_by;   ///< CandidateList::ordered_by
  Ranking base_ranking;                    ///< of all answers, nothing found yet
  std::vector<Candidate> base_candidates;  ///< those that there were when nothing was found yet
  std::vector<Evidence> base_evidence;     ///< of them, then
  std::vector<double> bad_rms;             ///< of each of `bad`: corners [px] or position [m], beside all findings
  std::vector<std::size_t> bad;            ///< observations that belong to no model, as indices into the measured ones given
  MeasuredCell measured;                   ///< without the bad ones
};

struct SearchLimits {
  std::size_t most = 6;                         ///< findings at which to stop
  std::set<std::string> refused = {};           ///< answers with a name that are none: Candidate::answer()
  bool curves = true;                           ///< whether a curve of unknown shape may be an answer
  std::string label = "searching for effects";  ///< for those who are told of the rounds
};

/// Searches. @param state  the identified cell. @param wild  observations that a robust fit left out by far; they are left out from the
/// start unless they are a run in time.
Selection selectEffects(const MeasuredCell& measured, const ModelState& state, const std::vector<std::size_t>& wild,
                        const SearchLimits& limits);

}  // namespace poecal
